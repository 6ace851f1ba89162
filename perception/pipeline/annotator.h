#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <typeindex>
#include <vector>

#include "mapping/base/error.h"
#include "mapping/base/options.h"
#include "mapping/base/text/json.h"
#include "mapping/base/time.h"
#include "perception/cas/cas.h"

namespace loci::perception {

/// Objects that annotators share: a recording, a map, a memory. At most one per C++ type, with shared
/// ownership.
class Resources {
 public:
  template <class T>
  void put(std::shared_ptr<T> resource) {
    resources_[typeid(T)] = {std::move(resource), false};
  }
  /// A resource that must not outlive the run (a file). Annotators with a time limit do not get it, because
  /// they may still be running when the run ends.
  template <class T>
  void put_for_run(std::shared_ptr<T> resource) {
    resources_[typeid(T)] = {std::move(resource), true};
  }
  /// All that may outlive the run.
  Resources lasting() const {
    Resources copy;
    for (const auto& [type, entry] : resources_)
      if (!entry.for_run) copy.resources_.emplace(type, entry);
    return copy;
  }
  /// nullptr when there is none.
  template <class T>
  T* find() const {
    const auto it = resources_.find(typeid(T));
    return it == resources_.end() ? nullptr : static_cast<T*>(it->second.resource.get());
  }
  /// Error with the hint when there is none.
  template <class T>
  T& get(const std::string& what, const std::string& hint = {}) const {
    if (T* found = find<T>()) return *found;
    throw Error("there is no " + what, {}, hint);
  }

 private:
  struct Entry {
    std::shared_ptr<void> resource;
    bool for_run = false;
  };
  std::map<std::type_index, Entry> resources_;
};

/// The capabilities of an annotator (as UIMA's descriptors). Inputs, outputs and so on are views
/// ("view:depth"), types by their short names ("Cluster", "GeometryAnnotation"), or features of types
/// ("Cluster.place"). Annotators that do not read or modify what another one outputs may run at the same
/// time, each on a copy of the CAS: what is not declared is not visible.
struct AnnotatorDescriptor {
  std::string name;
  std::string description;
  std::vector<std::string> inputs;                ///< required
  std::vector<std::string> outputs;               ///< added
  std::vector<std::string> optional_inputs = {};  ///< read when present; "*" = everything
  std::vector<std::string> modifies = {};         ///< written to, although output by others
  /// What it changes beside the CAS that others read or change, too, such as "memory". Everything from the
  /// first to the last annotator with one of these is done with a scene before it begins with the next.
  std::vector<std::string> shares = {};
  /// Whether it cannot start without options: a model, an index, a server. --goal takes it only when they are
  /// given.
  bool needs_options = false;
};

/// A frame of a recording.
struct FrameId {
  int64_t index = 0;  ///< as in the recording
  TimeNs time_ns = 0;
};

/// What an annotator gets besides the CAS.
struct Context {
  Resources& resources;
  Warnings& warnings;
  int threads = 1;
  Json configuration;                ///< of the whole pipeline, with defaults, for outputs
  bool alone = true;                 ///< no other annotator runs meanwhile
  std::optional<FrameId> next = {};  ///< the frame that is read after this one

  /// Whether a frame is one of a video: the next is taken less than a second later, from about the same
  /// place.
  bool in_video(TimeNs frame) const { return next && next->time_ns - frame < kSecond; }
};

/// An expert that reads a CAS and adds to it. Made for one run; frames come one after the other, on any
/// thread, and maybe before another annotator has seen the frame before (AnnotatorDescriptor::shares).
class Annotator {
 public:
  virtual ~Annotator() = default;
  virtual AnnotatorDescriptor descriptor() const = 0;
  /// Declares the options, once; the values live in the annotator.
  virtual void declare(OptionTable& /*table*/) {}
  /// Before the first frame: looks up resources; throws Error when it cannot start.
  virtual void start(Context& /*context*/) {}
  virtual void process(cas::Cas& cas, Context& context) = 0;
  /// After the last frame, also of a run that was interrupted or failed.
  virtual void finish(Context& /*context*/) {}
};

/// The source of scenes: each goes into a fresh CAS.
class Reader {
 public:
  virtual ~Reader() = default;
  virtual AnnotatorDescriptor descriptor() const = 0;
  virtual void declare(OptionTable& /*table*/) {}
  virtual void start(Context& context) = 0;
  /// Frames that there are, and how many of them were read or skipped.
  virtual size_t count() const = 0;
  virtual size_t position() const = 0;
  /// The frame that comes next; position() < count().
  virtual FrameId upcoming() const = 0;
  virtual void read_next(cas::Cas& cas, Context& context) = 0;
  virtual void skip(size_t frames) = 0;
};

/// Splits a scene into further CASes (a CAS multiplier, §2.1). A flow runs over each of them, and its
/// annotations are copied back. Made for one run; scenes come one after the other. Its descriptor declares
/// the inputs from the scene and the outputs in the new CASes.
class CasMultiplier {
 public:
  virtual ~CasMultiplier() = default;
  virtual AnnotatorDescriptor descriptor() const = 0;
  virtual void declare(OptionTable& /*table*/) {}
  virtual std::vector<std::unique_ptr<cas::Cas>> split(cas::Cas& scene, Context& context) = 0;
  /// Copies the annotations of a part of the last split() back.
  virtual void join(size_t part, cas::Cas& done, cas::Cas& scene) = 0;
};

}  // namespace loci::perception
