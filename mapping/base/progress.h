#pragma once

#include <string_view>

#include "mapping/base/error.h"

namespace loci {

/// Receives the progress of a stage and answers whether to go on. Stages know neither threads nor terminals.
class Progress {
 public:
  virtual ~Progress() = default;

  /// `fraction` in [0,1] of the stage, `text` the current activity. Returns false when the stage should stop.
  virtual bool update(double fraction, std::string_view text) = 0;

  /// update(), throwing Interrupted when the stage should stop. For stages without cleanup.
  void check(double fraction, std::string_view text) {
    if (!update(fraction, text)) throw Interrupted();
  }
};

/// Ignores progress and never stops.
class NoProgress : public Progress {
 public:
  bool update(double, std::string_view) override { return true; }
};

/// Maps a part [begin, end] of an outer progress to [0,1] of an inner stage.
class PartialProgress : public Progress {
 public:
  PartialProgress(Progress& outer, double begin, double end) : outer_(outer), begin_(begin), end_(end) {}
  bool update(double fraction, std::string_view text) override {
    return outer_.update(begin_ + fraction * (end_ - begin_), text);
  }

 private:
  Progress& outer_;
  double begin_;
  double end_;
};

}  // namespace loci
