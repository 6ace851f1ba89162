#pragma once

#include <exception>
#include <string>
#include <string_view>
#include <vector>

namespace loci {

/// Where something happened, as far as it is known: a file, a line in it (1-based, 0 = unknown), and a key or
/// name.
struct Place {
  std::string file;
  int line = 0;
  std::string key;

  /// "kitchen.yaml:12: scenes.time", leaving out what is unknown.
  std::string text() const;
};

/// The one exception of the project: what happened, where, and what to do about it. Its text is one line.
class Error : public std::exception {
 public:
  explicit Error(std::string what, Place place = {}, std::string hint = {});

  const char* what() const noexcept override { return text_.c_str(); }
  const std::string& message() const { return message_; }
  const Place& place() const { return place_; }
  const std::string& hint() const { return hint_; }

 private:
  std::string message_;
  Place place_;
  std::string hint_;
  std::string text_;
};

/// Thrown by a stage when its Progress asked it to stop. What was committed before stays.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// What is worth telling without failing. Collected by stages and readers, counted and shown by the apps.
class Warnings {
 public:
  void add(std::string text, const Place& place = {});
  const std::vector<std::string>& texts() const { return texts_; }
  bool empty() const { return texts_.empty(); }

 private:
  std::vector<std::string> texts_;
};

/// The candidate that is closest to `name` by edit distance, or "" if none is near enough to be what was
/// meant.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// "did you mean 'x'?" for an error's hint, or "" when nothing is near.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);

}  // namespace loci
