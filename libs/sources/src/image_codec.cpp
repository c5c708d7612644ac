// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "image_codec.h"

#include "engram/sources/image_bytes.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <csetjmp>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <zlib.h>

// After <cstdio>, which it needs.
#include "engram/base/error.h"

#include <jerror.h>
#include <jpeglib.h>

namespace engram::sources {
namespace {

namespace fs = std::filesystem;

Decoded failed(std::string why) { return {{}, std::move(why), false}; }

/// libjpeg's own handlers call exit(1) on errors and print warnings.
struct JpegErrors {
  jpeg_error_mgr manager;  // first: libjpeg hands back a pointer to it
  std::jmp_buf escape;
  char message[JMSG_LENGTH_MAX];
  int damage;  // warnings that mean lost pixels
};

void onJpegError(j_common_ptr info) {
  auto* errors = reinterpret_cast<JpegErrors*>(info->err);
  errors->manager.format_message(info, errors->message);
  std::longjmp(errors->escape, 1);
}

void onJpegMessage(j_common_ptr info, int level) {
  auto* errors = reinterpret_cast<JpegErrors*>(info->err);
  // Many cameras leave bytes between markers: harmless. All other warnings mean damaged pixels.
  if (level >= 0 || errors->manager.msg_code == JWRN_EXTRANEOUS_DATA) return;
  if (errors->damage++ == 0) errors->manager.format_message(info, errors->message);
}

/// The body of decodeJpeg: nothing with a destructor may live here, since longjmp runs none.
bool decodeJpegInto(jpeg_decompress_struct& info, JpegErrors& errors, std::span<const std::uint8_t> bytes,
                    cv::Mat& image) {
  if (setjmp(errors.escape)) return false;
  jpeg_create_decompress(&info);
  jpeg_mem_src(&info, bytes.data(), bytes.size());
  jpeg_read_header(&info, TRUE);
  if (!plausibleSize(info.image_width, info.image_height)) ERREXIT(&info, JERR_IMAGE_TOO_BIG);
  const bool grey = info.jpeg_color_space == JCS_GRAYSCALE;
  info.out_color_space = grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_start_decompress(&info);
  image.create(static_cast<int>(info.output_height), static_cast<int>(info.output_width),
               grey ? CV_8UC1 : CV_8UC3);
  while (info.output_scanline < info.output_height) {
    JSAMPROW row = image.ptr(static_cast<int>(info.output_scanline));
    jpeg_read_scanlines(&info, &row, 1);
  }
  jpeg_finish_decompress(&info);
  return errors.damage == 0;
}

Decoded decodeJpeg(std::span<const std::uint8_t> bytes) {
  jpeg_decompress_struct info{};
  JpegErrors errors{};
  info.err = jpeg_std_error(&errors.manager);
  errors.manager.error_exit = onJpegError;
  errors.manager.emit_message = onJpegMessage;
  Decoded out;
  const bool good = decodeJpegInto(info, errors, bytes, out.image);
  jpeg_destroy_decompress(&info);
  if (!good) return failed(std::string("damaged JPEG: ") + errors.message);
  return out;
}

Decoded decodeFile(std::span<const std::uint8_t> bytes) {
  const bool jpeg = bytes.size() > 2 && bytes[0] == 0xFF && bytes[1] == 0xD8;
  // A JPEG whose frame header is not found goes to libjpeg, which says what is damaged.
  const bool known = !jpeg || base::sizeInHeader(bytes).has_value();
  if (const std::string why = known ? base::imageRefusal(bytes) : ""; !why.empty()) return failed(why);
  if (jpeg) return decodeJpeg(bytes);
  Decoded out;
  try {
    const cv::Mat view(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data()));
    out.image = cv::imdecode(view, cv::IMREAD_ANYCOLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const std::exception&) {
    out.image.release();
  }
  if (out.image.empty()) return failed("not an image that can be decoded");
  return out;
}

Decoded decodeRaw(const EncodedImage& image, std::span<const std::uint8_t> bytes) {
  const auto width = image.size.width, height = image.size.height;
  if (!plausibleSize(width, height) || image.step < std::int64_t{width} * image.channels ||
      static_cast<std::int64_t>(bytes.size()) < image.step * height)
    return failed("the pixels are incomplete");
  const cv::Mat view(height, width, CV_8UC(image.channels), const_cast<std::uint8_t*>(bytes.data()),
                     static_cast<std::size_t>(image.step));
  Decoded out;
  if (image.bottomUp)
    cv::flip(view, out.image, 0);
  else
    out.image = view.clone();
  return out;
}

Decoded inflate(const EncodedImage& image) {
  if (image.step <= 0 || !plausibleSize(image.step, image.size.height))
    return failed("the pixels are incomplete");
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(image.step * image.size.height));
  uLongf length = pixels.size();
  if (uncompress(pixels.data(), &length, image.bytes.data(), image.bytes.size()) != Z_OK ||
      length != pixels.size())
    return failed("the compressed pixels are damaged");
  return decodeRaw(image, pixels);
}

}  // namespace

Decoded readImageFile(const std::string& path) {
  std::error_code status;
  const auto size = fs::file_size(path, status);
  if (status) return {{}, "no such file", true};
  if (size > (std::uintmax_t{1} << 29)) return failed("too large for an image");
  std::vector<std::uint8_t> bytes(size);
  std::ifstream in(path, std::ios::binary);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    return failed("cannot be read");
  return decodeFile(bytes);
}

Decoded decode(const EncodedImage& image, const std::string& folder) {
  using Kind = EncodedImage::Kind;
  Decoded out;
  switch (image.kind) {
    case Kind::kNone:
      return failed("an image without pixels");
    case Kind::kUnsupported:
      return failed(image.path);
    case Kind::kRaw:
      return decodeRaw(image, image.bytes);
    case Kind::kDeflated:
      return inflate(image);
    case Kind::kFile:
      out = decodeFile(image.bytes);
      break;
    case Kind::kExternal: {
      const std::string path = fs::path(image.path).is_absolute() ? image.path : folder + "/" + image.path;
      out = readImageFile(path);
      if (out.image.empty()) out.failure = path + ": " + out.failure;
      return out;
    }
  }
  if (!out.image.empty() && !image.size.empty() && image.size != out.image.size())
    return failed("damaged image: its size contradicts the rawlog");
  return out;
}

cv::Mat decodeImageBytes(std::span<const std::uint8_t> bytes, std::string& failure) {
  Decoded out = decodeFile(bytes);
  failure = out.failure;
  return std::move(out.image);
}

std::vector<std::uint8_t> encodeJpeg(const cv::Mat& image, int quality) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return bytes;
}

}  // namespace engram::sources
