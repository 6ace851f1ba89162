#pragma once

#include <string>
#include <string_view>

#include "perception/cas/cas.h"

namespace loci::perception::cas {

// UIMA's XML Metadata Interchange, by which its own implementations exchange CASes.

struct XmiOptions {
  /// Leaves out what the type system does not know (types, features) instead of refusing it.
  bool lenient = false;
};

/// Reads a CAS that UIMA wrote into an empty one. Every Sofa is a view of the name in its sofaID; members of
/// a View without sofa are indexed in "_InitialView". Arrays and lists of features without
/// multipleReferencesAllowed stand inside the feature. What was left out goes to `warnings`. Error with file
/// and line when the text is no XMI or does not fit the type system.
void from_xmi(Cas& cas, std::string_view xml, const std::string& file, const XmiOptions& options,
              Warnings& warnings);

/// Writes everything that views lead to, such that UIMA reads it. XMI cannot say all that a CAS can hold: a
/// view without sofa, an array that two features share without multipleReferencesAllowed, characters that XML
/// does not allow. Such things are written as near to it as UIMA allows, and put right for from_xmi() by
/// processing instructions `<?loci …?>`, which other readers pass over.
std::string to_xmi(const Cas& cas);

}  // namespace loci::perception::cas
