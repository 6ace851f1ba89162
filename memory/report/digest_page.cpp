#include "memory/report/digest_page.h"

#include <optional>
#include <set>
#include <vector>

#include "mapping/base/text/html.h"
#include "memory/questions/replies/answer_format.h"

namespace loci::memory {
namespace {

/// What an object looked like when it was last seen that day or before; empty when no image is stored.
std::string last_image(const Store& store, Id object, TimeNs until, const std::string& name) {
  const auto last = store.last_observation_before(object, until + 1, {}, {.at = until});
  if (!last || !last->observation.crop) return {};
  const BlobRow blob = store.blob(*last->observation.crop);
  const auto* bytes = reinterpret_cast<const unsigned char*>(blob.bytes.data());
  return html_image({bytes, blob.bytes.size()}, blob.media, name);
}

/// What is said, and the object whose image belongs to it.
struct DigestItem {
  std::string text;
  std::optional<ObjectRef> object = {};
};

/// A paragraph each, with the object's image where the page names it first; empty without items.
std::string section(const Store& store, const DigestAnswer& digest, const char* id, const char* heading,
                    const std::vector<DigestItem>& items, std::set<Id>& shown) {
  std::string body;
  for (const DigestItem& item : items) {
    body += "<div class=\"card\"><p>" + html_escape(item.text) + "</p>";
    if (item.object && shown.insert(item.object->id).second)
      body += last_image(store, item.object->id, digest.to, to_text(*item.object));
    body += "</div>\n";
  }
  return body.empty() ? body : html_section(id, heading, body);
}

}  // namespace

std::string digest_page(const Store& store, const DigestAnswer& digest) {
  const TimeWriter times(store);
  std::vector<DigestItem> misplaced, missing, changes;
  for (const MisplacedObject& object : digest.misplaced)
    misplaced.push_back({to_text(object), object.now.object});
  for (const ObjectBelief& belief : digest.missing)
    missing.push_back({format::belief_text(belief, times), belief.object});
  for (const Change& change : digest.changes)
    changes.push_back({format::when_text(change, times) + "  " + to_text(change), change.object});
  const std::string text = to_text(digest, times);
  std::set<Id> shown;
  std::string sections =
      html_section("digest", digest.day, "<p>" + html_escape(text.substr(0, text.find('\n'))) + "</p>");
  sections += section(store, digest, "misplaced", "Out of the usual place", misplaced, shown);
  sections += section(store, digest, "missing", "Missing", missing, shown);
  sections += section(store, digest, "changes", "Changed", changes, shown);
  return html_page("Digest of " + digest.day, sections);
}

}  // namespace loci::memory
