// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <unistd.h>

namespace engram::fuzz {

/// Bad input may be refused, and only so: every other exception ends the program.
template <class F>
void mayRefuse(F&& read) {
  try {
    read();
  } catch (const base::Error&) {
  }
}

/// A file for readers that take a path, in memory where there is such a folder, gone with the process.
class InputFile {
 public:
  explicit InputFile(const std::string& extension) {
    const char* memory = "/dev/shm";
    const auto folder =
        std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
    path_ = (folder / ("engram_fuzz_" + std::to_string(getpid()) + extension)).string();
  }
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::string& holding(std::span<const std::uint8_t> bytes) const {
    std::ofstream(path_, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return path_;
  }
  std::string folder() const { return std::filesystem::path(path_).parent_path().string(); }

 private:
  std::string path_;
};

inline std::string text(std::span<const std::uint8_t> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace engram::fuzz
