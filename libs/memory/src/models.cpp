// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/memory/models.h"

#include "engram/memory/static_view.h"
#include "replace.h"

namespace engram::memory {

void MemoryParams::describe(base::Params& p) {
  p.addChoice("memory", memory, "how a place remembers", {"fsh", "multi_store", "static", "replace"});
  p.addChoice("update_policy", update_policy,
              "a place learns from each verified image, or once while the robot passes it",
              {"per_image", "per_pass"});
  p.addChoice(
      "gate", gate,
      "localising with --adapt: a place learns what geometry has verified, or the most probable place "
      "learns every image unverified, as F algorithm 2 has it: one wrong answer poisons a place",
      {"verified", "none"});
}

std::unique_ptr<MemoryModel> makeMemoryModel(const MemoryParams& params, const FshParams& fsh,
                                             const MultiStoreParams& multiStore) {
  base::validate(params);
  if (params.memory == "static") return std::make_unique<Static>();
  if (params.memory == "replace") return std::make_unique<Replace>();
  if (params.memory == "multi_store") return std::make_unique<MultiStore>(multiStore);
  return std::make_unique<Fsh>(fsh);
}

}  // namespace engram::memory
