#pragma once

#include <string>
#include <vector>

#include "mapping/base/json.h"
#include "mapping/base/options.h"
#include "mapping/base/time.h"
#include "perception/cas/cas.h"
#include "perception/pipeline/resources.h"

namespace loci::perception {

/// What an annotator says about itself. Needs, makes and so on are views ("view:depth") and types by their
/// short names ("Cluster", "GeometryAnnotation"), or features of theirs ("Cluster.place"). Annotators of
/// which none reads or changes what another one writes may run at the same time, each on a copy of the CAS:
/// what is not declared is not seen.
struct AnnotatorDescriptor {
  std::string name;
  std::string sentence;
  std::vector<std::string> needs;         ///< cannot do without
  std::vector<std::string> makes;         ///< adds
  std::vector<std::string> uses = {};     ///< reads when it is there; "*" = everything
  std::vector<std::string> changes = {};  ///< writes to, although others made it
  /// Whether it cannot start without options: a model, an index, a server. --goal takes it when it is given.
  bool needs_options = false;
};

/// What an annotator has at hand besides the CAS.
struct Context {
  Resources& resources;
  Warnings& warnings;
  int threads = 1;
  Json configuration;  ///< of the whole pipeline, with defaults, for outputs
  bool alone = true;   ///< no other annotator runs meanwhile
};

/// An expert that reads a CAS and adds to it. Made for one run; frames come one after the other.
class Annotator {
 public:
  virtual ~Annotator() = default;
  virtual AnnotatorDescriptor descriptor() const = 0;
  /// Declares the options, once; the values live in the annotator.
  virtual void declare(OptionTable& /*table*/) {}
  /// Before the first frame: looks for resources, refuses to start with an Error.
  virtual void start(Context& /*context*/) {}
  virtual void process(cas::Cas& cas, Context& context) = 0;
  /// After the last frame, also when the run was interrupted.
  virtual void finish(Context& /*context*/) {}
};

/// Which frame of a recording.
struct FrameId {
  int64_t index = 0;  ///< as in the recording
  TimeNs time_ns = 0;
};

/// Where scenes come from: each goes into a fresh CAS.
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

}  // namespace loci::perception
