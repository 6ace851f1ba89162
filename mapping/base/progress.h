#pragma once

#include <string_view>

#include "mapping/base/error.h"

namespace loci {

/// How a stage tells how far it is and learns whether to go on (run logic knows no threads and no terminal).
class Progress {
 public:
  virtual ~Progress() = default;

  /// `fraction` in [0,1] of the stage, `text` what is being done. Returns false when the stage should stop.
  virtual bool update(double fraction, std::string_view text) = 0;

  /// update(), and Interrupted when the answer is to stop. For stages that have nothing to finish first.
  void check(double fraction, std::string_view text) {
    if (!update(fraction, text)) throw Interrupted();
  }
};

/// Says nothing, never stops.
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
