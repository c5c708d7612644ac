// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_command.h"
#include "engram/capture/discovery.h"

#include <nlohmann/json.hpp>

#include <ostream>

namespace engram::apps {
namespace {

class ListCommand final : public Program {
 public:
  std::string name() const override { return "list"; }
  std::string description() const override {
    return "The cameras that answer on the networks of this computer";
  }
  std::string examples() const override { return "  engram-capture list\n"; }
  void declare(CLI::App& app) override {
    app.add_option("--json", json_, "Write the list to this file")->type_name("FILE");
  }
  int run(std::ostream& out, std::ostream& err) override;

 private:
  std::string json_;
};

int ListCommand::run(std::ostream& out, std::ostream& err) {
  base::requireWritable(json_);
  nlohmann::json list = nlohmann::json::array();
  for (const auto& c : capture::discover()) {
    out << c.id << "  " << c.vendor << " " << c.model << ", serial " << c.serial << ", " << c.protocol;
    if (!c.address.empty()) out << " at " << c.address;
    out << "\n";
    list.push_back({{"id", c.id},
                    {"vendor", c.vendor},
                    {"model", c.model},
                    {"serial", c.serial},
                    {"address", c.address},
                    {"protocol", c.protocol}});
  }
  writeJson(json_, list);
  if (!list.empty()) return kOk;
  err << "engram-capture: no camera answers: is it switched on, is its address in the network of this "
         "computer's "
         "interface, and does a firewall let UDP port 3956 through?\n";
  return kError;
}

}  // namespace

std::unique_ptr<Program> makeListCommand() { return std::make_unique<ListCommand>(); }

}  // namespace engram::apps
