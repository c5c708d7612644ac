// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "paint.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace engram::world::paint {
namespace {

void box(cv::Mat& image, int x0, int y0, int x1, int y1, const Paint& colour, int thickness = cv::FILLED) {
  cv::rectangle(image, cv::Point(x0, y0), cv::Point(x1, y1), colour, thickness);
}

void gradient(cv::Mat& image, const Paint& top, const Paint& bottom) {
  for (int y = 0; y < image.rows; ++y)
    image.row(y).setTo(mix(top, bottom, static_cast<double>(y) / image.rows));
}

void randomShape(cv::Mat& image, const Paint& colour, Rng& rng) {
  const int w = image.cols, h = image.rows;
  const cv::Point p(pick(rng, 0, w), pick(rng, 0, h));
  switch (rng.below(4)) {
    case 0:
      cv::circle(image, p, pick(rng, w / 16, w / 4), colour, rng.below(2) ? cv::FILLED : 5, cv::LINE_AA);
      break;
    case 1:
      box(image, p.x, p.y, p.x + pick(rng, w / 10, w / 2), p.y + pick(rng, h / 16, h / 3), colour);
      break;
    case 2: {
      const cv::Point tri[3]{p, p + cv::Point(pick(rng, -w / 2, w / 2), pick(rng, 10, h / 3)),
                             p + cv::Point(pick(rng, -w / 2, w / 2), pick(rng, -h / 3, -10))};
      cv::fillConvexPoly(image, tri, 3, colour, cv::LINE_AA);
      break;
    }
    default:
      cv::line(image, p, {pick(rng, 0, w), pick(rng, 0, h)}, colour, pick(rng, 2, 14), cv::LINE_AA);
  }
}

std::string randomWord(Rng& rng, int letters) {
  static const std::string alphabet = "AEIOURSTLNMDCPBGHKFVW";
  std::string word;
  for (int i = 0; i < letters; ++i) word += alphabet[rng.below(static_cast<std::uint32_t>(alphabet.size()))];
  return word;
}

}  // namespace

void words(cv::Mat& image, cv::Point at, double height, const std::string& text, const Paint& ink,
           int thickness) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, height / 22.0, ink, thickness, cv::LINE_AA);
}

void scribble(cv::Mat& image, const cv::Rect& area, int lineHeight, const Paint& ink, Rng& rng) {
  for (int y = area.y + lineHeight; y < area.y + area.height; y += lineHeight) {
    int x = area.x;
    const int end = area.x + static_cast<int>(area.width * rng.uniform(0.6, 1.0));
    while (x < end) {
      const int length = std::min(pick(rng, lineHeight / 2, lineHeight * 3), end - x);
      box(image, x, y - lineHeight / 2, x + length, y - lineHeight / 6, ink);
      x += length + lineHeight / 2;
    }
  }
}

cv::Mat door(Rng rng, int kind) {
  static const Paint colours[]{{60, 95, 135}, {150, 120, 70}, {175, 180, 180}, {60, 70, 130}};
  const Paint colour = colours[kind % 4];
  cv::Mat image;
  cv::rotate(wood(rng.fork(1), colour), image, cv::ROTATE_90_CLOCKWISE);
  cv::resize(image, image, {256, 512});
  const Paint dark = colour * 0.6;
  if (kind % 2 == 0) {
    for (const int y : {50, 290}) {
      box(image, 45, y, 210, y + (y == 50 ? 200 : 170), dark, 4);
      box(image, 60, y + 15, 195, y + (y == 50 ? 185 : 155), colour * 1.1, 3);
    }
  } else {  // with a pane
    box(image, 60, 60, 195, 230, dark);
    box(image, 70, 70, 185, 220, {120, 125, 120});
    cv::line(image, {75, 210}, {180, 90}, {190, 195, 195}, 6, cv::LINE_AA);
    box(image, 20, 440, 236, 500, {150, 155, 160});
  }
  cv::circle(image, {225, 285}, 7, {190, 200, 205}, cv::FILLED, cv::LINE_AA);
  box(image, 200, 280, 226, 289, {190, 200, 205});
  box(image, 218, 300, 232, 320, {70, 75, 80});
  box(image, 0, 0, 255, 511, dark, 5);
  return image;
}

cv::Mat doorSign(Rng rng, int number) {
  cv::Mat image(128, 256, CV_8UC3, Paint(225, 228, 228));
  words(image, {14, 60}, 46, std::to_string(number), {40, 40, 40}, 5);
  scribble(image, {14, 72, 220, 44}, 18, {90, 90, 90}, rng);
  box(image, 0, 0, 255, 127, {120, 80, 50}, 5);
  return image;
}

cv::Mat poster(Rng rng) {
  cv::Mat image(256, 192, CV_8UC3);
  gradient(image, randomPaint(rng, 20, 250), randomPaint(rng, 20, 250));
  const int shapes = pick(rng, 4, 11);
  for (int i = 0; i < shapes; ++i) randomShape(image, randomPaint(rng, 0, 255), rng);
  const Paint paper = rng.below(2) ? Paint(240, 240, 240) : Paint(30, 30, 35);
  const Paint ink = paper[0] > 100 ? Paint(30, 30, 30) : Paint(235, 235, 235);
  const int top = pick(rng, 8, 200);
  if (rng.below(3)) box(image, 0, top, 191, top + 40, paper);
  words(image, {8, top + 30}, pick(rng, 16, 28), randomWord(rng, pick(rng, 4, 8)), ink, 3);
  const int text = pick(rng, 20, 170);
  if (rng.below(2)) box(image, 12, text, 150, text + 60, paper);
  if (rng.below(4))
    scribble(image, {18, text, 126, 60}, pick(rng, 8, 13), rng.below(2) ? ink : randomPaint(rng, 0, 120),
             rng);
  box(image, 0, 0, 191, 255, rng.below(2) ? Paint(235, 235, 235) : Paint(40, 40, 45), 6);
  return image;
}

cv::Mat noticeBoard(Rng rng) {
  cv::Mat image(256, 512, CV_8UC3, Paint(95, 140, 175));
  for (int i = 0; i < 26; ++i) {
    const int w = pick(rng, 30, 80), h = pick(rng, 40, 100), x = pick(rng, 10, 500 - w),
              y = pick(rng, 10, 245 - h);
    const Paint paper = rng.below(3) ? Paint(225, 230, 230) : randomPaint(rng, 110, 250);
    box(image, x + 2, y + 2, x + w + 2, y + h + 2, {60, 85, 110});
    box(image, x, y, x + w, y + h, paper);
    scribble(image, {x + 5, y + 10, w - 10, h - 14}, pick(rng, 7, 12), randomPaint(rng, 10, 110), rng);
    cv::circle(image, {x + w / 2, y + 4}, 3, randomPaint(rng, 0, 230), cv::FILLED, cv::LINE_AA);
  }
  box(image, 0, 0, 511, 255, {70, 90, 110}, 10);
  return image;
}

cv::Mat bookshelf(Rng rng) {
  cv::Mat image(512, 256, CV_8UC3, Paint(45, 60, 75));
  const Paint frame = mix({80, 125, 165}, {200, 205, 205}, rng.uniform());
  const int shelves = pick(rng, 5, 6), pitch = 500 / shelves;
  for (int s = 0; s < shelves; ++s) {
    const int base = 6 + (s + 1) * pitch;
    int x = 10;
    while (x < 236) {
      const int w = pick(rng, 6, 20), h = pick(rng, pitch * 5 / 10, pitch * 9 / 10);
      if (rng.below(12) == 0) {
        x += pick(rng, 10, 40);
        continue;
      }
      const Paint cover = randomPaint(rng, 20, 230);
      box(image, x, base - h, std::min(x + w, 245), base, cover);
      if (w > 9)
        box(image, x + 2, base - h * 8 / 10, x + w - 2, base - h * 6 / 10, mix(cover, {230, 230, 230}, 0.7));
      cv::line(image, {x, base - h}, {x, base}, cover * 0.5, 1);
      x += w + 1;
    }
    box(image, 0, base, 255, base + 6, frame);
  }
  box(image, 0, 0, 255, 511, frame, 10);
  return image;
}

cv::Mat cabinet(Rng rng) {
  const Paint colour = mix({170, 175, 175}, randomPaint(rng, 70, 190), 0.5);
  cv::Mat image(256, 256, CV_8UC3, colour);
  const int drawers = pick(rng, 3, 4);
  for (int i = 0; i < drawers; ++i) {
    const int y = i * 256 / drawers;
    box(image, 5, y + 5, 250, y + 256 / drawers - 4, colour * 0.8, 3);
    box(image, 95, y + 24, 160, y + 34, colour * 0.45);
    box(image, 100, y + 42, 155, y + 58, {225, 228, 228});
    scribble(image, {104, y + 42, 46, 15}, 7, {60, 60, 60}, rng);
  }
  return image;
}

cv::Mat cardboard(Rng rng) {
  cv::Mat image(128, 128, CV_8UC3, Paint(90, 140, 180) * rng.uniform(0.8, 1.1));
  box(image, 0, 56, 127, 72, {120, 170, 205});
  words(image, {10, 40}, 18, randomWord(rng, 5), {30, 40, 60}, 2);
  for (int i = 0; i < 3; ++i) box(image, 12 + i * 30, 86, 34 + i * 30, 112, {40, 55, 80}, 2 - (i == 1) * 3);
  return image;
}

cv::Mat screen(Rng rng) {
  cv::Mat image(128, 256, CV_8UC3, Paint(25, 25, 25));
  box(image, 8, 8, 247, 112, randomPaint(rng, 60, 170));
  for (int i = 0; i < 3; ++i) {
    const int x = pick(rng, 10, 150), y = pick(rng, 12, 60);
    box(image, x, y, x + 90, y + 48, {225, 225, 225});
    scribble(image, {x + 4, y + 4, 80, 42}, 8, {70, 70, 70}, rng);
  }
  return image;
}

cv::Mat radiator(Rng) {
  cv::Mat image(128, 256, CV_8UC3, Paint(215, 220, 220));
  for (int x = 6; x < 256; x += 16) {
    box(image, x, 8, x + 9, 120, {235, 238, 238});
    cv::line(image, {x + 11, 8}, {x + 11, 120}, {120, 125, 125}, 3);
  }
  box(image, 0, 0, 255, 6, {190, 195, 195});
  return image;
}

cv::Mat smallThing(Rng rng, int kind) {
  cv::Mat image(64, 64, CV_8UC3, Paint(230, 232, 232));
  switch (kind % 6) {
    case 0:  // switch
      box(image, 12, 12, 51, 51, {180, 185, 185}, 3), box(image, 16, 30, 47, 34, {120, 120, 120});
      break;
    case 1:  // sockets
      for (const int x : {18, 46}) cv::circle(image, {x, 32}, 12, {90, 95, 95}, 3, cv::LINE_AA);
      break;
    case 2:  // exit
      image.setTo(Paint(70, 150, 30));
      words(image, {4, 28}, 16, "EXIT", {240, 240, 240}, 2);
      cv::arrowedLine(image, {10, 46}, {54, 46}, {240, 240, 240}, 5, cv::LINE_AA, 0, 0.4);
      break;
    case 3:  // extinguisher
      box(image, 18, 16, 46, 63, {30, 30, 190}), box(image, 24, 4, 40, 16, {40, 40, 40});
      box(image, 22, 28, 42, 44, {220, 225, 225});
      break;
    case 4:  // clock
      image.setTo(Paint(60, 60, 60));
      cv::circle(image, {32, 32}, 29, {240, 240, 240}, cv::FILLED, cv::LINE_AA);
      cv::line(image, {32, 32}, {32, 10}, {20, 20, 20}, 3, cv::LINE_AA);
      cv::line(image, {32, 32}, {46, 38}, {20, 20, 20}, 3, cv::LINE_AA);
      break;
    default:  // a note
      image.setTo(randomPaint(rng, 150, 250));
      scribble(image, {6, 4, 52, 56}, 10, {50, 50, 60}, rng);
  }
  return image;
}

cv::Mat lamp(Rng) {
  cv::Mat image(64, 64, CV_8UC3, Paint(255, 255, 255));
  for (int i = 8; i < 64; i += 16) cv::line(image, {i, 0}, {i, 63}, {215, 215, 215}, 3);
  box(image, 0, 0, 63, 63, {170, 175, 175}, 4);
  return image;
}

cv::Mat rug(Rng rng) {
  const Paint a = randomPaint(rng, 30, 170), b = randomPaint(rng, 60, 230), c = randomPaint(rng, 60, 230);
  cv::Mat image(256, 256, CV_8UC3, a);
  box(image, 10, 10, 245, 245, b, 8), box(image, 26, 26, 229, 229, c, 3);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const cv::Point p(60 + 45 * i, 60 + 45 * j);
      const cv::Point diamond[4]{p + cv::Point(0, -18), p + cv::Point(18, 0), p + cv::Point(0, 18),
                                 p + cv::Point(-18, 0)};
      cv::fillConvexPoly(image, diamond, 4, (i + j) % 2 ? b : c, cv::LINE_AA);
    }
  return image;
}

cv::Mat person(Rng rng) {
  cv::Mat image(256, 128, CV_8UC3);
  const Paint skin = mix({170, 195, 235}, {60, 85, 130}, rng.uniform());
  const Paint hair = randomPaint(rng, 15, 90), shirt = randomPaint(rng, 25, 235),
              trousers = randomPaint(rng, 20, 130);
  image.setTo(hair);
  cv::ellipse(image, {64, 24}, {17, 19}, 0, 0, 360, skin, cv::FILLED, cv::LINE_AA);
  for (const int x : {57, 71}) cv::circle(image, {x, 20}, 2, {30, 30, 30}, cv::FILLED);
  cv::line(image, {58, 32}, {70, 32}, {70, 70, 140}, 2);
  box(image, 0, 40, 127, 142, shirt);
  const auto pattern = rng.below(3);
  const Paint second = randomPaint(rng, 25, 235);
  if (pattern == 0)
    for (int y = 46; y < 142; y += 14) box(image, 0, y, 127, y + 5, second);
  if (pattern == 1) scribble(image, {44, 62, 40, 40}, 12, second, rng);
  cv::line(image, {64, 42}, {64, 142}, shirt * 0.7, 2);
  for (const int x : {20, 104}) cv::line(image, {x, 46}, {x, 150}, shirt * 0.6, 3);
  box(image, 0, 138, 127, 145, {30, 35, 45});
  box(image, 0, 146, 127, 244, trousers);
  for (const int x : {30, 64, 98}) cv::line(image, {x, 150}, {x, 244}, trousers * 0.65, 3);
  box(image, 0, 244, 127, 255, {30, 30, 35});
  return image;
}

}  // namespace engram::world::paint
