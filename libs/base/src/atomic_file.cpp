// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/atomic_file.h"

#include "engram/base/error.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace engram::base {

namespace fs = std::filesystem;

void writeAtomically(const std::string& path, bool overwrite,
                     const std::function<void(const std::string&)>& write) {
  if (path.empty()) throw Error("the output needs a file name");
  if (fs::is_directory(path)) throw Error("cannot write '" + path + "': it is a folder");
  if (fs::exists(path) && !overwrite)
    throw Error("'" + path + "' exists already. Allow overwriting, or choose another name");
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder))
    throw Error("cannot write '" + path + "': folder '" + folder.string() + "' does not exist");
  // The ending stays last: some writers choose the format by it.
  const std::string temporary = (folder / (".partial-" + fs::path(path).filename().string())).string();
  try {
    write(temporary);
    fs::rename(temporary, path);
  } catch (const fs::filesystem_error& e) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw Error("cannot write '" + path + "': " + e.code().message());
  } catch (const Error& e) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw Error("cannot write '" + path + "': " + e.what());
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void writeText(const std::string& path, const std::string& text, bool overwrite) {
  writeAtomically(path, overwrite, [&](const std::string& temporary) {
    errno = 0;
    std::ofstream out(temporary, std::ios::binary);
    out << text;
    out.close();
    if (!out) throw Error(std::strerror(errno != 0 ? errno : EIO));
  });
}

}  // namespace engram::base
