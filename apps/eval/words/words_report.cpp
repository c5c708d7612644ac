// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_report.h"

namespace engram::apps {
namespace {

using nlohmann::json;

Spread spreadOf(const MeanStd& m) { return {m.mean, m.std, m.count > 0}; }

/// One setting and transition.
struct Located {
  const LocalisationRun* run;
  ProtocolFigures figures;
};

std::vector<Located> locatedIn(const WordsWorldResult& result) {
  std::vector<Located> rows;
  for (const auto& run : result.localisation) rows.push_back({&run, figuresOf(run.attempts)});
  return rows;
}

/// The errors of the trajectory, and what each relaxer made of them.
void addErrors(Columns<MappingRun>& c) {
  using R = MappingRun;
  c.add("ate_odometry_m", &R::ateOdometry)
      .csv(4)
      .json()
      .page("odometry [m]", fixed(2))
      .text("odometry", -10, fixed(3, "m"));
  c.add("ate_before_m", &R::ateBefore)
      .csv(4)
      .json()
      .page("before [m]", fixed(2))
      .text("before", -8, fixed(3, "m"));
  for (const auto& name : comparedRelaxers())
    c.add("ate_" + name + "_m", [name](const R& run) { return run.after.at(name).ate; })
        .csv(4)
        .json("ate_after_m." + name)
        .page(name + " [m]", fixed(2))
        .text(name == "mrpt_levmarq" ? "levmarq" : name, -8, fixed(3, "m"));
  for (const auto& name : comparedRelaxers())
    c.add("", [name](const R& run) {
       return run.after.at(name).cpuSeconds;
     }).json("relaxation_cpu_seconds." + name);
  c.add("ate_map_m", &R::ateMap).csv(4).json();
}

/// What of the attempts and their images became of what, by cause.
void addCauses(Columns<Located>& c) {
  for (std::size_t k = 0; k < kMisses; ++k) {
    const std::string cause = toString(static_cast<Miss>(k));
    auto& misses = c.add("not accepted: " + cause, [k](const Located& l) { return l.figures.misses[k]; });
    misses.json("not_accepted." + cause);
    if (k < 3) misses.csv();  // the others end an attempt
  }
  for (std::size_t k = 0; k < kMisses; ++k) {
    const std::string cause = toString(static_cast<Miss>(k));
    c.add("ended by: " + cause, [k](const Located& l) { return l.figures.ends[k]; })
        .csv()
        .json("ended_by." + cause);
  }
}

}  // namespace

ResultTable mappingTable(const WordsWorldResult& result) {
  using R = MappingRun;
  Columns<R> c;
  c.add("building", &R::building).csv().json().page("building").text("mapping", 10);
  c.add("length_m", &R::length).csv(2).json().page("drive [m]", fixed(0));
  c.add("images", &R::images).csv().json().page("images").text("images", -6);
  c.add("places", &R::places).csv().json().page("places").text("places", -6);
  c.add("", [](const R& r) {
     return line("%4d + %d false", r.closuresThatAre(true), r.closuresThatAre(false));
   }).text("closures", -14);
  c.add("recognised", &R::recognised).csv().json().page("joined").text("joined", -8);
  c.add("recognised_wrong", &R::recognisedWrong).csv().json().page("of these wrong");
  c.add("true_closures", [](const R& r) { return r.closuresThatAre(true); })
      .csv()
      .json()
      .page("true closures");
  c.add("false_closures", [](const R& r) { return r.closuresThatAre(false); })
      .csv()
      .json()
      .page("false closures");
  c.add("dropped_closures", &R::dropped).json();
  c.add("restored_closures", &R::restored).json();
  c.add("closures", [](const R& r) { return closureTable({{r}, {}}).toJson(); }).json();
  addErrors(c);
  c.add("cpu_seconds", &R::cpuSeconds).csv(2).json().page("CPU [s]", fixed(1));
  c.add("drive_seconds", &R::seconds).csv(1).json();
  c.add("", [](const R& r) {
     return line("  %.0f s for a drive of %.0f s", r.cpuSeconds, r.seconds);
   }).text("  CPU", 0);
  return c.table(result.mapping);
}

ResultTable closureTable(const WordsWorldResult& result) {
  struct Row {
    const std::string& building;
    const ClosureRecord& closure;
  };
  std::vector<Row> rows;
  for (const auto& run : result.mapping)
    for (const auto& closure : run.closures) rows.push_back({run.building, closure});
  Columns<Row> c;
  c.add("building", [](const Row& r) { return r.building; }).csv();
  c.add("image", [](const Row& r) { return r.closure.image; }).csv().json().page("image");
  c.add("place", [](const Row& r) { return r.closure.place; }).csv().json().page("place");
  c.add("place_image", [](const Row& r) { return r.closure.placeImage; }).csv().json().page("made by image");
  c.add("distance_m", [](const Row& r) { return r.closure.distance; })
      .csv(3)
      .json()
      .page("true distance [m]", fixed(2));
  c.add("turn_deg", [](const Row& r) { return r.closure.turn * 180 / M_PI; })
      .csv(1)
      .json()
      .page("turn [deg]");
  c.add("right", [](const Row& r) { return r.closure.right; }).csv().json().page("right");
  c.add("kept", [](const Row& r) { return r.closure.kept; }).csv().json();
  c.add("", [](const Row& r) { return r.closure.kept ? "yes" : "dropped"; }).page("in the map");
  return c.table(rows);
}

ResultTable localisationTable(const WordsWorldResult& result) {
  using L = Located;
  Columns<L> c;
  c.add("setting", [](const L& l) { return l.run->setting; })
      .csv()
      .json()
      .page("setting")
      .text("locating", 10);
  c.add("transition", [](const L& l) { return l.run->transition; })
      .csv()
      .json()
      .page("transition")
      .text("transition", 10);
  c.add("attempts", [](const L& l) { return l.figures.attempts; })
      .csv()
      .json()
      .page("attempts")
      .text("attempts", -8);
  const auto spread = [&c](const std::string& name, MeanStd ProtocolFigures::*member) {
    c.add(name + "_mean", [member](const L& l) { return spreadOf(l.figures.*member); })
        .csv(3, name + "_std")
        .json(name + ".mean", name + ".std")
        .page(name, fixed(1))
        .text(name, -12, fixed(1));
  };
  spread("trials", &ProtocolFigures::trials);
  spread("trackings", &ProtocolFigures::trackings);
  c.add("accepted_images", [](const L& l) { return l.figures.accepted; }).csv().json();
  c.add("wrong_images", [](const L& l) { return l.figures.wrong; }).csv().json();
  c.add("wrong", [](const L& l) { return l.figures.wrongShare(); })
      .json()
      .page("wrong [%]", percent(1))
      .text("wrong", -7, percent(1, " %"));
  c.add("never", [](const L& l) { return l.figures.never; }).csv().json().page("never").text("never", -6);
  addCauses(c);
  c.add("images", [](const L& l) { return l.run->shown; }).json().page("images");
  c.add("images_learned", [](const L& l) { return l.run->learned; }).json().page("learnt");
  c.add("places", [](const L& l) { return l.run->places; }).json();
  c.add("ms_per_image", [](const L& l) { return l.run->msPerImage; })
      .csv(1)
      .json()
      .page("CPU an image [ms]")
      .text("ms/image", -8);
  return c.table(locatedIn(result));
}

ResultTable endsTable(const WordsWorldResult& result) {
  using L = Located;
  Columns<L> c;
  c.add("", [](const L& l) { return l.run->setting; }).page("setting");
  c.add("", [](const L& l) { return l.run->transition; }).page("transition");
  for (std::size_t k = 0; k < kMisses; ++k)
    c.add("", [k](const L& l) { return l.figures.ends[k]; }).page(toString(static_cast<Miss>(k)));
  return c.table(locatedIn(result));
}

ResultTable attemptTable(const WordsWorldResult& result) {
  struct Row {
    const LocalisationRun& run;
    const Attempt& attempt;
  };
  std::vector<Row> rows;
  for (const auto& run : result.localisation)
    for (const Attempt& attempt : run.attempts) rows.push_back({run, attempt});
  Columns<Row> c;
  c.add("setting", [](const Row& r) { return r.run.setting; }).csv();
  c.add("transition", [](const Row& r) { return r.run.transition; }).csv();
  c.add("start", [](const Row& r) { return r.attempt.start; }).csv();
  c.add("located", [](const Row& r) { return r.attempt.located; }).csv();
  c.add("trials", [](const Row& r) { return r.attempt.trials; }).csv();
  c.add("trackings", [](const Row& r) { return r.attempt.trackings; }).csv();
  c.add("end", [](const Row& r) { return toString(r.attempt.end); }).csv();
  return c.table(rows);
}

json toJson(const WordsWorldResult& result) {
  return {{"mapping", mappingTable(result).toJson()}, {"localisation", localisationTable(result).toJson()}};
}

std::string toText(const WordsWorldResult& result) {
  std::string text = mappingTable(result).toText() + "\n" + localisationTable(result).toText();
  const auto paper = [&text](const char* where, const char* trials, const char* trackings, int ms) {
    text +=
        line("%-10s %-10s %8d %12s %12s %7s %6s %8d\n", "paper", where, 100, trials, trackings, "", "", ms);
  };
  paper("indoor", "5 (4)", "5 (3)", 115);
  paper("outdoor", "2 (1)", "12 (10)", 644);
  return text;
}

}  // namespace engram::apps
