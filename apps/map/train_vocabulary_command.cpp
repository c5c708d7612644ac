// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "train_vocabulary_command.h"

#include "engram/apps/program.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/store/map_file.h"

#include <algorithm>
#include <ostream>

namespace engram::apps {

void TrainVocabularyCommand::declare(CLI::App& command) {
  command.add_option("maps", maps_, "Map files, made with one extractor")->required();
  command.add_option("--out", output_, "Vocabulary file to write")->required();
  command.add_option("--set", overrides_, "Override one key: vocabulary.key=value (repeatable)")
      ->take_all()
      ->allow_extra_args(false);
  command.add_flag("--overwrite", overwrite_, "Replace the file if it exists");
  command.add_flag("-q,--quiet", quiet_, "Print errors only");
  command.add_flag("--dump-config", dump_, "Print every key in force with its meaning, and stop");
}

vocabulary::TreeParams TrainVocabularyCommand::readParams() const {
  vocabulary::TreeParams params;
  base::Config config;
  config.bind("vocabulary", params);
  base::IniFile ini = base::IniFile::parse("", "command line");
  for (const auto& assignment : overrides_) ini.override(assignment);
  config.read(ini);
  return params;
}

/// The descriptors of all places, one set for each.
std::vector<types::Descriptors> TrainVocabularyCommand::readMaps() const {
  std::vector<types::Descriptors> images;
  std::string extractor;
  for (const std::string& path : maps_) {
    const auto file = store::MapFile::open(path, store::Access::kReadOnly);
    const std::string own = file.header().extractor;
    if (path != maps_.front() && own != extractor)
      throw base::Error("map '" + path + "' was made with the extractor " + own + ", '" + maps_.front() +
                        "' with " + extractor + ": a vocabulary needs maps of one extractor");
    extractor = own;
    const auto map = file.load();
    for (const auto& [id, place] : map.places()) images.push_back(place.memory->features.descriptors);
  }
  return images;
}

int TrainVocabularyCommand::run(std::ostream& out, std::ostream& err) {
  vocabulary::TreeParams params = readParams();
  if (dump_) {
    base::Config config;
    config.bind("vocabulary", params);
    out << config.dump();
    return kOk;
  }
  requireNew(output_, overwrite_);
  const auto images = readMaps();
  std::vector<const types::Descriptors*> views;
  std::size_t descriptors = 0;
  for (const auto& image : images) {
    views.push_back(&image);
    descriptors += image.size();
  }
  base::Progress progress(quiet_ ? nullptr : &err, "training");
  try {
    const auto tree = vocabulary::VocabularyTree::train(views, params, [&](double share) {
      if (base::interrupted()) throw base::Interrupted("training");
      progress.update(share, static_cast<std::size_t>(share * static_cast<double>(descriptors)));
    });
    progress.finish();
    tree.save(output_, overwrite_);
    if (!quiet_)
      out << output_ << ": " << tree.words() << " words from "
          << std::min(descriptors, static_cast<std::size_t>(params.max_training)) << " of the " << descriptors
          << " descriptors of " << images.size() << " places\n";
  } catch (const base::Interrupted&) {
    progress.finish();
    err << "engram-map: interrupted while training; '" << output_ << "' was not written\n";
    return kPartial;
  }
  return kOk;
}

}  // namespace engram::apps
