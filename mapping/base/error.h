#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace loci {

/// A position in a file, as far as it is known: the file, a line (1-based, 0 = unknown), and a key or name.
struct FileLocation {
  std::string file;
  int line = 0;
  std::string key;

  /// "kitchen.yaml:12: scenes.time", leaving out what is unknown.
  std::string text() const;
};

/// The exception of the project: what happened, where, and what to do about it. Its text is one line.
class Error : public std::exception {
 public:
  explicit Error(std::string what, FileLocation location = {}, std::string hint = {});

  const char* what() const noexcept override { return text_.c_str(); }
  const std::string& message() const { return message_; }
  const FileLocation& location() const { return location_; }
  const std::string& hint() const { return hint_; }

 private:
  std::string message_;
  FileLocation location_;
  std::string hint_;
  std::string text_;
};

/// Thrown by a stage when its Progress asks it to stop. Committed results stay.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Problems that do not stop a stage. Stages and readers collect them; the programs count and print them.
class Warnings {
 public:
  void add(std::string text, const FileLocation& location = {});
  const std::vector<std::string>& texts() const { return texts_; }
  bool empty() const { return texts_.empty(); }

 private:
  std::vector<std::string> texts_;
};

/// The candidate with the smallest edit distance to `name`, or "" when all are too different.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// "did you mean 'x'?" for an error's hint, or "" when nothing is near.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace loci
