// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/building.h"

#include <utility>

namespace engram::world {
namespace {

constexpr std::uint32_t kFirstNumber = 101;  // of the doors

/// Repeats what one storey has on all of them, where the plan is the same there.
class Storeys {
 public:
  explicit Storeys(const Plan& plan) : plan_(plan), model_(plan.storeys / 2) {}

  int count() const { return plan_.storeys; }
  bool isModel(int cell) const { return cell % plan_.columns / plan_.pitch() == model_; }
  int shift(int storey) const { return (storey - model_) * plan_.pitch(); }  ///< [cells]
  float metres(int storey) const { return static_cast<float>(shift(storey) * plan_.cell); }

  /// The cell of the model that one of any storey is like.
  int modelOf(int cell) const {
    return cell - cell % plan_.columns + model_ * plan_.pitch() + cell % plan_.columns % plan_.pitch();
  }
  /// Whether the wall behind a spot of the model and the floor before it are the same on a storey.
  bool alike(const WallSpot& spot, int storey) const {
    for (int i = 0; i < spot.cells; ++i) {
      const int cell = spot.cell + i * (spot.side < 2 ? plan_.columns : 1);
      const int x = cell % plan_.columns, y = cell / plan_.columns;
      const int dx = kSteps[spot.side][0], dy = kSteps[spot.side][1], by = shift(storey);
      if (plan_.at(x + by, y) != plan_.at(x, y) || plan_.at(x + by + dx, y + dy) != plan_.at(x + dx, y + dy))
        return false;
    }
    return true;
  }
  WallSpot on(WallSpot spot, int storey) const {
    spot.cell += shift(storey);
    if (spot.side < 2) return spot;  // along y
    spot.a0 += metres(storey);
    spot.a1 += metres(storey);
    return spot;
  }

 private:
  const Plan& plan_;
  int model_;
};

std::vector<FixedSpot> repeat(const Storeys& storeys, const std::vector<FixedSpot>& fixtures,
                              std::uint32_t doors) {
  std::vector<FixedSpot> all;
  const auto on = [&](FixedSpot f, int storey) {
    f.spot = storeys.on(f.spot, storey);
    const auto per = doors / static_cast<std::uint32_t>(storeys.count());
    if (f.kind == Fixture::kDoorSign)
      f.look = kFirstNumber + (f.look - kFirstNumber + static_cast<std::uint32_t>(storey) * per) % doors;
    return f;
  };
  for (int k = 0; k < storeys.count(); ++k)
    for (const FixedSpot& f : fixtures)
      if (storeys.isModel(f.spot.cell) && storeys.alike(f.spot, k)) all.push_back(on(f, k));
  return all;
}

}  // namespace

/// What stands and hangs on the storey in the middle is on all of them; doors keep numbers of their own.
void Building::repeatStoreys() {
  const Storeys storeys(plan_);
  for (Room& room : rooms_) {
    const int model = roomOf(storeys.modelOf(room.cells.front()));
    if (model >= 0) room.style = rooms_[static_cast<std::size_t>(model)].style;
  }
  for (Door& door : doors_) door.kind = doors_.front().kind;
  fixtures_ = repeat(storeys, fixtures_, static_cast<std::uint32_t>(doors_.size()));

  const auto spots = std::exchange(posterSpots_, {});
  posterModels_.clear();
  std::vector<int> models(spots.size(), -1);
  for (int k = storeys.count() / 2, n = 0; n < storeys.count(); ++n, k = (k + 1) % storeys.count())
    for (std::size_t i = 0; i < spots.size(); ++i) {
      if (!storeys.isModel(spots[i].cell) || !storeys.alike(spots[i], k)) continue;
      if (models[i] < 0) models[i] = static_cast<int>(posterSpots_.size());  // the model comes first
      posterModels_.push_back(models[i]);
      posterSpots_.push_back(storeys.on(spots[i], k));
    }

  const auto pieces = std::exchange(furniture_, {});
  for (int k = 0; k < storeys.count(); ++k)
    for (Furniture piece : pieces) {
      const int cell = cellAt(piece.centre.x(), piece.centre.y());
      if (!storeys.isModel(cell)) continue;
      piece.centre.x() += storeys.metres(k);
      const int there = cell + storeys.shift(k);
      piece.room = plan_.at(there % plan_.columns, there / plan_.columns) ==
                           plan_.cells[static_cast<std::size_t>(cell)]
                       ? roomOf(there)
                       : -1;
      if (piece.room >= 0 && fits(piece, furniture_, -1)) furniture_.push_back(piece);
    }
}

}  // namespace engram::world
