// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/text_file.h"

#include "engram/base/error.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace engram::base {
namespace {

constexpr std::size_t kMaxText = std::size_t{1} << 28;  // [byte] a TUM file of 100 days at 0.3 Hz has as much

void refuseOtherEncodings(const std::string& text, const std::string& name) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw Error(name + ": is text in UTF-16; save it as UTF-8");
  if (text.find('\0') != std::string::npos) throw Error(name + ": is no text: it holds bytes that are zero");
}

}  // namespace

std::string plainText(std::string text, const std::string& name) {
  refuseOtherEncodings(text, name);
  const std::size_t begin = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  std::size_t to = 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    const bool isPair = text[i] == '\r' && i + 1 < text.size() && text[i + 1] == '\n';
    if (!isPair) text[to++] = text[i] == '\r' ? '\n' : text[i];
  }
  text.resize(to);
  if (!text.empty() && text.back() != '\n') text += '\n';
  return text;
}

std::string readTextFile(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw Error(path + ": is a folder; a file is wanted");
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rbe"), std::fclose);
  if (!file) throw Error(path + ": cannot be opened; does the file exist and may you read it?");
  std::string text;
  char block[1 << 16];
  for (std::size_t n; (n = std::fread(block, 1, sizeof block, file.get())) > 0;) {
    text.append(block, n);
    if (text.size() > kMaxText) throw Error(path + ": is too large for a text file");
  }
  if (std::ferror(file.get()) != 0) throw Error(path + ": cannot be read: " + std::strerror(errno));
  return plainText(std::move(text), path);
}

}  // namespace engram::base
