#pragma once

#include "mapping/base/text/json_fwd.h"
#include "perception/cas/cas.h"

namespace loci::perception::cas {

/// Where large arrays go when a feature structure is written, so that the text stays small.
class BlobSink {
 public:
  virtual ~BlobSink() = default;
  /// Arrays of more bytes than this are put here.
  virtual size_t threshold() const { return 256; }
  /// Keeps the bytes (little-endian elements) and returns a key under which a BlobSource finds them. Equal
  /// bytes should get equal keys, or the text is not canonical.
  virtual std::string put(std::string_view bytes) = 0;
};

/// Where large arrays come from.
class BlobSource {
 public:
  virtual ~BlobSource() = default;
  /// The bytes, kept alive by `owner`: arrays use the memory without copying.
  struct Bytes {
    std::shared_ptr<const void> owner;
    std::string_view bytes;
  };
  /// Throws Error when there is no such key.
  virtual Bytes get(const std::string& key) = 0;
};

/// A feature structure with everything that it refers to, whatever its type, as canonical JSON:
///
///     {"root": "#1", "structures": [{"id": 1, "type": "loci.scene.Scene", "features": {"timestamp": 5,
///      "clusters": ["#2", "#3"]}}, ...]}
///
/// Ids count the structures in order of reachability (breadth first, features in order of declaration), so
/// equal graphs give equal text, however they were made. Unset features are left out; references to what was
/// deleted are null. NaN and infinities are the strings "NaN", "Infinity", "-Infinity"; floats have as few
/// digits as bring them back. An array to which only one feature refers stands inside that feature; shared
/// ones are structures with "elements". Arrays of more than 256 bytes are {"base64": ...}, or {"blob": key}
/// with a sink.
Json to_json(const FeatureStructure& root, BlobSink* sink = nullptr);

/// The elements of an array of numbers, booleans or texts as a list, however many.
Json elements_to_json(const FeatureStructure& array);

/// A whole CAS: {"views": [{"name": ..., "sofa": "#1", "index": ["#2", ...]}], "structures": [...]}. What no
/// view leads to is not part of it. An index is a set: its members come in a canonical order of their
/// content.
Json to_json(const Cas& cas, BlobSink* sink = nullptr);

/// Brings either back: returns the root, or null for a whole CAS, whose views are added to `cas`. Throws
/// Error that names the place when the JSON does not fit the type system; `cas` may then hold unreachable
/// structures.
FeatureStructure from_json(Cas& cas, const Json& json, BlobSource* source = nullptr);

}  // namespace loci::perception::cas
