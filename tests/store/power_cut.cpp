// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "power_cut.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace engram::store::test {
namespace {

constexpr std::size_t kSector = 512;

void put(std::string& file, std::size_t at, std::string_view bytes) {
  if (file.size() < at + bytes.size()) file.resize(at + bytes.size(), '\0');
  file.replace(at, bytes.size(), bytes);
}

/// Each sector is there, is not, or ends somewhere within.
void putSome(std::string& file, const DiskEvent& write, base::Rng& rng) {
  const auto begin = static_cast<std::size_t>(write.at), end = begin + write.bytes.size();
  for (std::size_t at = begin; at < end;) {
    const std::size_t next = std::min(end, (at / kSector + 1) * kSector);
    const std::string_view sector(write.bytes.data() + (at - begin), next - at);
    const std::uint32_t fate = rng.below(9);
    if (fate < 4) put(file, at, sector);
    if (fate == 4) put(file, at, sector.substr(0, rng.below(static_cast<std::uint32_t>(sector.size()))));
    at = next;
  }
}

/// A file with or without a name.
struct Node {
  std::string synced;
  std::vector<const DiskEvent*> pending;

  void sync() {
    for (const DiskEvent* event : pending)
      if (event->kind == DiskEvent::Kind::kWrite)
        put(synced, static_cast<std::size_t>(event->at), event->bytes);
      else
        synced.resize(static_cast<std::size_t>(event->at), '\0');
    pending.clear();
  }

  std::string afterCut(base::Rng& rng) const {
    std::string file = synced;
    for (const DiskEvent* event : pending)
      if (event->kind == DiskEvent::Kind::kWrite)
        putSome(file, *event, rng);
      else if (rng.below(2) == 0)
        file.resize(static_cast<std::size_t>(event->at), '\0');
    return file;
  }
};

class Disk {
 public:
  void happen(const DiskEvent& event) {
    switch (event.kind) {
      case DiskEvent::Kind::kCreate:
        rename(event.path, nodes_.size());
        nodes_.emplace_back();
        break;
      case DiskEvent::Kind::kDelete:
        rename(event.path, std::nullopt);
        break;
      case DiskEvent::Kind::kWrite:
      case DiskEvent::Kind::kTruncate:
        if (names_.contains(event.path)) nodes_[names_[event.path]].pending.push_back(&event);
        break;
      case DiskEvent::Kind::kSync:
        if (names_.contains(event.path)) nodes_[names_[event.path]].sync();
        break;
    }
    if (event.syncsFolder) nameAll(renamed_.size(), syncedNames_), renamed_.clear();
  }

  Files afterCut(base::Rng& rng) const {
    auto names = syncedNames_;
    nameAll(rng.below(static_cast<std::uint32_t>(renamed_.size()) + 1), names);
    Files files;
    for (const auto& [path, node] : names) files[path] = nodes_[node].afterCut(rng);
    return files;
  }

 private:
  using Names = std::map<std::string, std::size_t>;
  struct Renamed {
    std::string path;
    std::optional<std::size_t> node;
  };

  static void name(Names& names, const Renamed& change) {
    if (change.node)
      names[change.path] = *change.node;
    else
      names.erase(change.path);
  }
  void nameAll(std::size_t count, Names& names) const {
    for (std::size_t i = 0; i < count; ++i) name(names, renamed_[i]);
  }
  void rename(const std::string& path, std::optional<std::size_t> node) {
    renamed_.push_back({path, node});
    name(names_, renamed_.back());
  }

  std::vector<Node> nodes_;
  Names names_, syncedNames_;
  std::vector<Renamed> renamed_;  // not synced yet, in order
};

}  // namespace

Files afterPowerCut(std::span<const DiskEvent> events, base::Rng& rng) {
  Disk disk;
  for (const DiskEvent& event : events) disk.happen(event);
  return disk.afterCut(rng);
}

}  // namespace engram::store::test
