// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/types/frame_report.h"

namespace engram::types {

MemoryChange& MemoryChange::operator+=(const MemoryChange& o) {
  rehearsed += o.rehearsed;
  added += o.added;
  pruned += o.pruned;
  promoted += o.promoted;
  demoted += o.demoted;
  longTerm += o.longTerm;
  shortTerm += o.shortTerm;
  return *this;
}

const char* toString(Outcome outcome) {
  switch (outcome) {
    case Outcome::kSkipped:
      return "skipped";
    case Outcome::kUnusable:
      return "unusable";
    case Outcome::kNewPlace:
      return "new_place";
    case Outcome::kRecognised:
      return "recognised";
    case Outcome::kRefused:
      return "refused";
  }
  return "?";
}

const char* toString(AcceptedBy by) {
  switch (by) {
    case AcceptedBy::kNothing:
      return "nothing";
    case AcceptedBy::kGeometry:
      return "geometry";
    case AcceptedBy::kSequence:
      return "sequence";
  }
  return "?";
}

}  // namespace engram::types
