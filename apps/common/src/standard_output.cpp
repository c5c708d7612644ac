// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/standard_output.h"

#include "engram/base/output_file.h"

#include <array>
#include <cerrno>
#include <string_view>
#include <unistd.h>

namespace engram::apps {

class StandardOutput::Buffer : public std::streambuf {
 public:
  Buffer() { setp(room_.data(), room_.data() + room_.size()); }

 protected:
  int_type overflow(int_type c) override {
    sync();
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }

  int sync() override {
    const std::string_view bytes(pbase(), static_cast<std::size_t>(pptr() - pbase()));
    setp(room_.data(), room_.data() + room_.size());  // what cannot be written is not tried again
    const int error = base::writeAll(STDOUT_FILENO, bytes);
    if (error == EPIPE) throw base::ClosedPipe();
    if (error != 0) throw base::Error("standard output cannot be written: " + base::reasonOf(error));
    return 0;
  }

 private:
  std::array<char, 1 << 16> room_;
};

StandardOutput::StandardOutput() : std::ostream(nullptr), buffer_(std::make_unique<Buffer>()) {
  rdbuf(buffer_.get());
  exceptions(std::ios::badbit);  // what the buffer throws passes
  if (::isatty(STDOUT_FILENO)) setf(std::ios::unitbuf);
}

StandardOutput::~StandardOutput() = default;

}  // namespace engram::apps
