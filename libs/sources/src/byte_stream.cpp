// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "byte_stream.h"

#include "engram/base/error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <zlib.h>

namespace engram::sources {
namespace fs = std::filesystem;

struct ByteStream::Inflater {
  Inflater() : input(1 << 16) {
    if (inflateInit2(&stream, 15 + 16) != Z_OK) throw std::bad_alloc();  // 16: with the header of gzip
  }
  ~Inflater() { inflateEnd(&stream); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  z_stream stream{};
  std::vector<std::uint8_t> input;
  bool inMember = true;  // false between the members of a file made of several
};

ByteStream::ByteStream(const std::string& path) : window_(kWindow) {
  std::error_code status;
  if (!fs::exists(path, status)) throw base::Error(path + ": no such file");
  if (fs::is_directory(path, status)) throw base::Error(path + ": is a folder, not a file");
  size_ = static_cast<double>(fs::file_size(path, status));
  if (!status && size_ == 0) throw base::Error(path + ": the file is empty");
  file_ = std::fopen(path.c_str(), "rb");
  if (!file_) throw base::Error(path + ": cannot be opened: " + std::strerror(errno));
  std::uint8_t magic[2] = {};
  const bool gzip = std::fread(magic, 1, 2, file_) == 2 && magic[0] == 0x1F && magic[1] == 0x8B;
  std::rewind(file_);
  if (gzip) inflater_ = std::make_unique<Inflater>();
}

ByteStream::~ByteStream() {
  if (file_) std::fclose(file_);
}

double ByteStream::progress() const {
  return size_ > 0 ? std::clamp(static_cast<double>(consumed_) / size_, 0.0, 1.0) : 1.0;
}

std::size_t ByteStream::readFile(std::uint8_t* to, std::size_t n) {
  errno = 0;
  const std::size_t got = std::fread(to, 1, n, file_);
  if (got == 0) {
    atEnd_ = true;
    if (std::ferror(file_)) error_ = std::string("the file cannot be read: ") + std::strerror(errno);
  }
  consumed_ += got;
  return got;
}

std::size_t ByteStream::inflateInto(std::uint8_t* to, std::size_t n) {
  z_stream& stream = inflater_->stream;
  if (stream.avail_in == 0) {
    stream.next_in = inflater_->input.data();
    stream.avail_in = static_cast<unsigned>(readFile(inflater_->input.data(), inflater_->input.size()));
    if (stream.avail_in == 0) {
      if (inflater_->inMember && error_.empty())
        error_ = "the compressed data end too early: the file is truncated";
      return 0;
    }
  }
  if (!inflater_->inMember) {
    if (stream.next_in[0] != 0x1F) {
      atEnd_ = true;  // bytes after the end, which gzip ignores too
      return 0;
    }
    inflateReset(&stream);
    inflater_->inMember = true;
  }
  stream.next_out = to;
  stream.avail_out = static_cast<unsigned>(n);
  const int code = inflate(&stream, Z_NO_FLUSH);
  if (code == Z_STREAM_END) {
    inflater_->inMember = false;
  } else if (code != Z_OK && code != Z_BUF_ERROR) {
    atEnd_ = true;
    const std::string message = stream.msg ? stream.msg : "zlib error";
    // A wrong checksum shows only at the end: nobody can say which of the objects read before are damaged.
    error_ = message == "incorrect data check" ? "the checksum is wrong: something that was read is damaged"
                                               : "the compressed data are damaged (" + message + ")";
  }
  return n - stream.avail_out;
}

void ByteStream::fill(std::size_t n) {
  std::memmove(window_.data(), window_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  while (end_ < n && !atEnd_) {
    std::uint8_t* to = window_.data() + end_;
    end_ += inflater_ ? inflateInto(to, kWindow - end_) : readFile(to, kWindow - end_);
  }
}

std::span<const std::uint8_t> ByteStream::peek(std::size_t n) {
  if (end_ - begin_ < n) fill(n);
  return {window_.data() + begin_, end_ - begin_};
}

void ByteStream::skip(std::size_t n) {
  begin_ += n;
  position_ += n;
}

bool ByteStream::read(void* to, std::size_t n) {
  auto* out = static_cast<std::uint8_t*>(to);
  while (n > 0) {
    const auto seen = peek(1);
    if (seen.empty()) return false;
    const std::size_t part = std::min(n, seen.size());
    std::memcpy(out, seen.data(), part);
    skip(part);
    out += part;
    n -= part;
  }
  return true;
}

}  // namespace engram::sources
