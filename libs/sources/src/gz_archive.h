// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/serialization/CArchive.h>

#include <cstdint>
#include <string>
#include <zlib.h>

namespace engram::sources {

/// Throws base::Error with what to do about this errno.
[[noreturn]] void failWriting(const std::string& path, int error);

/// MRPT's archive onto a gzip file whose write errors are not lost: MRPT's own stream ignores those of the
/// last block.
class GzArchive final : public mrpt::serialization::CArchive {
 public:
  /// Takes the descriptor; `path` is for messages.
  GzArchive(int descriptor, std::string path);
  ~GzArchive() override;
  GzArchive(const GzArchive&) = delete;
  GzArchive& operator=(const GzArchive&) = delete;

  /// Ends a member of the gzip file and hands it to the system, or with `sync` to the disk: up to here the
  /// file is whole, whatever happens later.
  void flush(bool sync);
  /// The last flush; nothing can be written afterwards.
  void finish();
  /// Cuts off what came after the last flush, without writing anything.
  void cutBack() noexcept;

  std::uint64_t size() const;  ///< of the file so far [bytes], without what is still in memory

  void bytes(const void* data, std::size_t n);
  template <class T>
  void value(T v) {
    bytes(&v, sizeof v);
  }
  void text(const std::string& s) {
    value(static_cast<std::uint32_t>(s.size()));
    bytes(s.data(), s.size());
  }
  void header(const std::string& name, int version) {
    value(static_cast<std::uint8_t>(name.size() | 0x80));
    bytes(name.data(), name.size());
    value(static_cast<std::uint8_t>(version));
  }

 protected:
  size_t write(const void* data, size_t n) override {
    bytes(data, n);
    return n;
  }
  size_t read(void* to, size_t n) override;

 private:
  void toDisk() const;

  std::string path_;
  int descriptor_ = -1;
  gzFile file_ = nullptr;
  std::uint64_t whole_ = 0;  // bytes of the file that a flush has completed
  bool dirty_ = false;       // something came since
};

}  // namespace engram::sources
