// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "connection.h"

#include "engram/base/error.h"

namespace engram::store {

std::int64_t Connection::number(const char* sql) {
  Statement statement(*this, sql);
  if (!statement.step()) throw base::Error("map '" + path() + "': it is damaged");
  return statement.integer(0);
}

Statement& Statement::bind(int position, std::uint64_t value) {
  cursor_->bind(position, value);
  return *this;
}

Statement& Statement::bind(int position, const Blob& value) {
  cursor_->bind(position, value);
  return *this;
}

Statement& Statement::bind(int position, const std::string& value) {
  cursor_->bind(position, value);
  return *this;
}

void Statement::run() {
  while (step()) {
  }
  cursor_->reset();
}

std::string Statement::text(int column) const {
  const auto bytes = blob(column);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace engram::store
