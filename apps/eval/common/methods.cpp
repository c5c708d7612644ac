// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/methods.h"

#include <string>
#include <utility>

namespace engram::apps {
namespace {

Method memoryMethod(const std::string& name, pipeline::PipelineParams params, const std::string& model) {
  params.memory.memory = model;
  return {name, std::move(params), 0};
}

Method multiStore(const pipeline::PipelineParams& pipeline, int shortTerm, int longTerm) {
  Method method = memoryMethod("multi_store_" + std::to_string(shortTerm) + "_" + std::to_string(longTerm),
                               pipeline, "multi_store");
  method.params.multi_store.stm_states = shortTerm;
  method.params.multi_store.ltm_states = longTerm;
  return method;
}

/// F-15 so that the votes decide, not the floor (F-E10): new features by the rank of their response, every
/// sighting nearly a whole vote, votes that fade by a fifth an update, and a floor of a few tens. Of
/// thresholds from 0.1 to 0.7, with and without fading, this did best.
Method voting(const pipeline::PipelineParams& pipeline) {
  Method method = memoryMethod("fsh_votes", pipeline, "fsh");
  memory::FshParams& fsh = method.params.fsh;
  fsh.new_vote = "rank";
  fsh.vote_variance = "fixed";
  fsh.fixed_sigma = 0.5;
  fsh.ltm_threshold = 0.3;
  fsh.ltm_min_features = 40;
  fsh.decay = 0.8;
  return method;
}

/// F algorithm 2 as printed (F-E16).
Method ungated(const pipeline::PipelineParams& pipeline) {
  Method method = memoryMethod("fsh_ungated", pipeline, "fsh");
  method.params.memory.gate = "none";
  return method;
}

}  // namespace

std::vector<Method> comparedMethods(const pipeline::PipelineParams& pipeline, int bowWords) {
  std::vector<Method> methods{memoryMethod("fsh", pipeline, "fsh"),
                              multiStore(pipeline, 4, 5),
                              multiStore(pipeline, 2, 8),
                              {"bow_80", pipeline, 80},
                              {"bow_" + std::to_string(bowWords), pipeline, bowWords},
                              memoryMethod("static", pipeline, "static"),
                              memoryMethod("replace", pipeline, "replace"),
                              memoryMethod("fsh_learned", pipeline, "fsh")};
  methods.back().params.fsh.thresholds = "learned";
  methods.push_back(voting(pipeline));
  methods.push_back(ungated(pipeline));
  return methods;
}

std::vector<Method> touredMethods(const pipeline::PipelineParams& pipeline) {
  return {multiStore(pipeline, 2, 8), multiStore(pipeline, 3, 8), memoryMethod("fsh", pipeline, "fsh"),
          memoryMethod("static", pipeline, "static"), memoryMethod("replace", pipeline, "replace")};
}

std::vector<Method> staticPlaceMethods(const pipeline::PipelineParams& pipeline) {
  return {memoryMethod("fsh", pipeline, "fsh"), multiStore(pipeline, 2, 8),
          memoryMethod("static", pipeline, "static")};
}

std::vector<Method> sweptMethods(const pipeline::PipelineParams& pipeline) {
  std::vector<Method> methods;
  for (int age = 1; age <= 7; ++age) {
    methods.push_back(memoryMethod("prune_view_" + std::to_string(age), pipeline, "fsh"));
    methods.back().params.fsh.prune_view = age;
  }
  for (int tenth = 1; tenth <= 9; ++tenth) {
    methods.push_back(memoryMethod("ltm_threshold_0." + std::to_string(tenth), pipeline, "fsh"));
    methods.back().params.fsh.ltm_threshold = tenth / 10.0;
    // The default floor would decide in place of the threshold.
    methods.back().params.fsh.ltm_min_features = 40;
  }
  return methods;
}

}  // namespace engram::apps
