// Collects the findings of checks about one robot, each with its place.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "robocell/scene/inspection/finding.h"

namespace robocell::internal {

class Findings {
 public:
  // `source_of` returns the place of a field in a subject's configuration.
  using SourceOf = std::function<std::string(const std::string& subject, std::string_view field)>;
  Findings(std::string subject, SourceOf source_of)
      : subject_(std::move(subject)), source_of_(std::move(source_of)) {}

  // Adds a warning at a field of the robot's configuration ("home_noise.arm"). The text names the
  // field if necessary. `edit` is the part of the text for `edits`.
  void Warn(std::string_view field, std::string text, std::string edit = "") {
    WarnOf(subject_, field, std::move(text), std::move(edit));
  }
  // Adds a warning whose line begins with the field: "home: 'arm' and 'post' touch ...". A text
  // that begins with its own place keeps that instead.
  void WarnAbout(const std::string& field, const std::string& text, std::string edit = "");
  // Adds a warning about a part of the robot, "robot 'left' / camera 'wrist'".
  void WarnOf(const std::string& subject, std::string_view field, std::string text,
              std::string edit = "") {
    list_.push_back({subject, Severity::kWarning, source_of_(subject, field), std::move(text),
                     std::move(edit)});
  }
  // Adds a warning at a line of a model: "arm.xml:12".
  void WarnAt(std::string source, std::string text, std::string edit = "") {
    list_.push_back(
        {subject_, Severity::kWarning, std::move(source), std::move(text), std::move(edit)});
  }
  void Note(std::string text) {
    list_.push_back({subject_, Severity::kNote, "", std::move(text), ""});
  }

  const std::vector<Finding>& list() const { return list_; }

 private:
  std::string subject_;
  SourceOf source_of_;
  std::vector<Finding> list_;
};

}  // namespace robocell::internal
