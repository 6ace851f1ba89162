#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "mapping/base/text/base64.h"
#include "perception/cas/xmi.h"
#include "perception/cas/xmi_text.h"

namespace loci::perception::cas {
namespace {

using tinyxml2::XMLElement;

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

/// A number as UIMA writes it, whole text; Error at `place` otherwise.
template <typename T>
T number_from(const std::string& text, const FileLocation& place) {
  T value{};
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  if constexpr (std::is_floating_point_v<T>) {
    if (text == "NaN") return std::numeric_limits<T>::quiet_NaN();
    if (text == "Infinity") return std::numeric_limits<T>::infinity();
    if (text == "-Infinity") return -std::numeric_limits<T>::infinity();
  }
  const auto done = std::from_chars(begin, end, value);
  if (done.ec != std::errc() || done.ptr != end)
    throw Error(fmt::format("'{}' is no such number", text), place);
  return value;
}

bool bool_from(const std::string& text, const FileLocation& place) {
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  throw Error(fmt::format("'{}' is neither true nor false", text), place);
}

uint8_t byte_from(const std::string& digits, const FileLocation& place) {
  unsigned value = 0;
  const auto done = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (digits.size() != 2 || done.ptr != digits.data() + 2)
    throw Error(fmt::format("'{}' is no byte in hexadecimal", digits), place);
  return static_cast<uint8_t>(value);
}

/// "uima.tcas.Annotation" of an element <tcas:Annotation> with xmlns:tcas="http:///uima/tcas.ecore".
std::string type_name(const std::string& name, const std::map<std::string, std::string>& spaces,
                      const FileLocation& place) {
  const size_t colon = name.find(':');
  const std::string prefix = colon == std::string::npos ? "" : name.substr(0, colon);
  std::string local = colon == std::string::npos ? name : name.substr(colon + 1);
  const auto space = spaces.find(prefix);
  if (space == spaces.end()) {
    if (prefix.empty()) return local;
    throw Error(fmt::format("the prefix '{}' is not declared", prefix), place);
  }
  std::string package = space->second;
  if (package.starts_with("http://")) package.erase(0, 7);
  package.erase(0, package.find_first_not_of('/'));
  if (package.ends_with(".ecore")) package.resize(package.size() - 6);
  std::replace(package.begin(), package.end(), '/', '.');
  return package == "uima.noNamespace" || package.empty() ? local : package + "." + local;
}

/// The values of a feature: one from an attribute, any number from child elements.
struct Values {
  std::vector<std::string> texts;
  bool from_children = false;
};

class XmiReader {
 public:
  XmiReader(Cas& cas, std::string file, const XmiOptions& options, Warnings& warnings)
      : cas_(cas),
        system_(cas.type_system()),
        file_(std::move(file)),
        options_(options),
        warnings_(warnings) {}

  void read(std::string_view xml) {
    tinyxml2::XMLDocument document;
    const std::string text = with_blanks_kept(xml);
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      throw Error(fmt::format("this is no XML: {}", document.ErrorName()),
                  {file_, document.ErrorLineNum(), {}});
    const XMLElement* root = document.RootElement();
    if (root == nullptr || !std::string_view(root->Name()).ends_with("XMI"))
      throw Error("this is no XMI", {file_, 1, {}}, "its root element is <xmi:XMI>");
    for (const auto* each = root->FirstAttribute(); each != nullptr; each = each->Next())
      if (std::string_view(each->Name()).starts_with("xmlns:")) spaces_[each->Name() + 6] = each->Value();
    read_notes(document);
    for (const XMLElement* each = root->FirstChildElement(); each != nullptr;
         each = each->NextSiblingElement())
      create(*each);
    for (const Item& item : items_) fill(item);
    for (const auto& [id, feature, target] : references_) at_id(id).set(feature, at_id(target));
    for (const XMLElement* each : view_elements_) read_view(*each);
  }

 private:
  struct Item {
    FeatureStructure structure;
    std::string id;
    const XMLElement* element;
    FileLocation place;
  };

  /// What to_xmi() noted because XMI cannot say it.
  void read_notes(const tinyxml2::XMLDocument& document) {
    for (const auto* node = document.FirstChild(); node != nullptr; node = node->NextSibling()) {
      const auto* declaration = node->ToDeclaration();
      if (declaration == nullptr) continue;
      const std::vector<std::string> note = words(declaration->Value());
      if (note.size() < 3 || note[0] != "loci") continue;
      const std::string third = note.size() > 3 ? note[3] : "";
      if (note[1] == "unset") unset_.insert({note[2], third});
      if (note[1] == "no-view") no_view_.insert(note[2]);
      if (note[1] == "view") view_names_[note[2]] = bytes_from_base64(third);
      if (note[1] == "no-sofa") no_sofa_[note[2]] = bytes_from_base64(third);
      if (note[1] == "reference" && note.size() == 5) references_.push_back({note[2], third, note[4]});
      if (note[1] == "text" && note.size() >= 5)
        texts_[{note[2], third, note[4]}] = note.size() > 5 ? bytes_from_base64(note[5]) : "";
    }
  }

  FileLocation place_of(const XMLElement& element) const {
    return {file_, element.GetLineNum(), element.Name()};
  }

  void leave_out(const std::string& what, const FileLocation& place) {
    if (!options_.lenient) throw Error(what, place, "--lenient leaves it out");
    warnings_.add(what + ", left out", place);
  }

  void create(const XMLElement& element) {
    FileLocation place = place_of(element);
    std::string name = type_name(element.Name(), spaces_, place);
    if (name.ends_with("[]")) name = "uima.cas.FSArray";
    if (name == "uima.cas.NULL") return;
    if (name == "uima.cas.View") {
      view_elements_.push_back(&element);
      return;
    }
    const char* given = element.Attribute("xmi:id");
    const std::string id = given == nullptr ? "" : given;
    if (!id.empty()) place.key = "xmi:id " + id;
    if (no_sofa_.contains(id)) {
      views_[id] = no_sofa_.at(id);
      cas_.view(no_sofa_.at(id));
      return;
    }
    const std::optional<Type> type = system_.find(name);
    if (!type) {
      dropped_.insert(id);
      return leave_out(fmt::format("the type system has no type {}", name), place);
    }
    const bool is_array = type->kind() == Kind::kArray;
    const FeatureStructure made =
        is_array && type->component_kind() != Kind::kStructure
            ? array(type->component_kind(), values(element, "elements"), id, "elements", place)
            : cas_.create(*type);
    if (!id.empty() && !made_.emplace(id, made).second)
      throw Error(fmt::format("the xmi:id {} is used twice", id), place);
    items_.push_back({made, id, &element, place});
    if (name == "uima.cas.Sofa" && !no_view_.contains(id)) add_view(made, id, element, place);
  }

  void add_view(const FeatureStructure& sofa, const std::string& id, const XMLElement& element,
                const FileLocation& place) {
    const char* name = element.Attribute("sofaID");
    const auto noted = view_names_.find(id);
    if (noted == view_names_.end() && name == nullptr) throw Error("the sofa has no sofaID", place);
    // Old versions of UIMA called the first view so.
    const std::string given = noted != view_names_.end() ? noted->second : name;
    views_[id] = given == "_DefaultTextSofaName" ? kInitialView : given;
    cas_.view(views_[id]).adopt_sofa(sofa);
  }

  Values values(const XMLElement& element, const std::string& name) const {
    Values result;
    if (const char* attribute = element.Attribute(name.c_str())) result.texts.emplace_back(attribute);
    for (const XMLElement* child = element.FirstChildElement(name.c_str()); child != nullptr;
         child = child->NextSiblingElement(name.c_str())) {
      if (!result.from_children) result.texts.clear();
      result.from_children = true;
      const char* href = child->Attribute("href");
      const char* text = child->GetText();
      result.texts.emplace_back(href != nullptr && *href == '#' ? href + 1 : text == nullptr ? "" : text);
    }
    return result;
  }

  /// Values of an array or list: an attribute has them all in one, but for texts.
  static std::vector<std::string> several(const Values& values, Kind component) {
    if (values.from_children) return values.texts;
    const std::string text = values.texts.empty() ? "" : values.texts.front();
    if (component != Kind::kString) return words(text);
    return text.empty() ? std::vector<std::string>() : std::vector<std::string>{text};
  }

  std::string noted_text(const std::string& text, const std::string& id, const std::string& feature,
                         size_t index) const {
    const auto noted = texts_.find({id, feature, std::to_string(index)});
    return noted == texts_.end() ? text : noted->second;
  }

  template <typename T, typename Convert>
  static RawBuffer buffer(const std::vector<std::string>& texts, const Convert& convert) {
    using Stored = std::conditional_t<std::is_same_v<T, bool>, uint8_t, T>;
    const auto kept = std::make_shared<std::vector<Stored>>();
    for (const std::string& text : texts) kept->push_back(convert(text));
    return Buffer<T>(kept, reinterpret_cast<const T*>(kept->data()), kept->size());
  }

  FeatureStructure array(Kind kind, const Values& given, const std::string& id, const std::string& feature,
                         const FileLocation& place) {
    std::vector<std::string> texts = several(given, kind);
    const auto numbers = [&]<typename T>(T) {
      return buffer<T>(texts, [&](const std::string& text) { return number_from<T>(text, place); });
    };
    switch (kind) {
      case Kind::kBoolean:
        return cas_.create_array(kind, buffer<bool>(texts, [&](const std::string& text) {
                                   return static_cast<uint8_t>(bool_from(text, place));
                                 }));
      case Kind::kByte: {
        std::string digits;
        for (const std::string& text : texts) digits += text;
        texts.clear();
        for (size_t i = 0; i < digits.size(); i += 2) texts.push_back(digits.substr(i, 2));
        return cas_.create_array(
            kind, buffer<uint8_t>(texts, [&](const std::string& text) { return byte_from(text, place); }));
      }
      case Kind::kShort:
        return cas_.create_array(kind, numbers(int16_t{}));
      case Kind::kInteger:
        return cas_.create_array(kind, numbers(int32_t{}));
      case Kind::kLong:
        return cas_.create_array(kind, numbers(int64_t{}));
      case Kind::kFloat:
        return cas_.create_array(kind, numbers(float{}));
      case Kind::kDouble:
        return cas_.create_array(kind, numbers(double{}));
      default: {
        for (size_t i = 0; i < texts.size(); ++i) texts[i] = noted_text(texts[i], id, feature, i);
        return cas_.create_array(kind, Buffer<std::string>(std::move(texts)));
      }
    }
  }

  FeatureStructure at_id(const std::string& id) const {
    const auto found = made_.find(id);
    if (found == made_.end())
      throw Error(fmt::format("refers to {}, which is not there", id), {file_, 0, {}});
    return found->second;
  }

  FeatureStructure reference(const std::string& id, const FileLocation& place) {
    if (id == "0" || id.empty()) return {};
    const auto found = made_.find(id);
    if (found != made_.end()) return found->second;
    if (!dropped_.contains(id)) throw Error(fmt::format("refers to {}, which is not there", id), place);
    return {};
  }

  std::vector<FeatureStructure> references(const Values& given, const FileLocation& place) {
    std::vector<FeatureStructure> found;
    for (const std::string& id : several(given, Kind::kStructure)) found.push_back(reference(id, place));
    return found;
  }

  /// A chain of nodes that ends in an empty one.
  FeatureStructure list(Kind component, const Values& given, const std::string& id,
                        const std::string& feature, const FileLocation& place) {
    const TypeSystem::ListTypes& types = system_.list_types(component);
    const std::vector<std::string> texts = several(given, component);
    FeatureStructure first = cas_.create(types.empty);
    for (size_t i = texts.size(); i-- > 0;) {
      const FeatureStructure node = cas_.create(types.node);
      if (component == Kind::kStructure)
        node.set("head", reference(texts[i], place));
      else if (component == Kind::kString)
        node.set("head", noted_text(texts[i], id, feature, i));
      else if (component == Kind::kInteger)
        node.set("head", number_from<int32_t>(texts[i], place));
      else
        node.set("head", number_from<float>(texts[i], place));
      node.set("tail", first);
      first = node;
    }
    return first;
  }

  void fill(const Item& item) {
    const Type type = item.structure.type();
    if (type.kind() == Kind::kArray) {
      if (type.component_kind() == Kind::kStructure)
        item.structure.set_elements(references(values(*item.element, "elements"), item.place));
      return;
    }
    for (const auto* each = item.element->FirstAttribute(); each != nullptr; each = each->Next())
      if (std::string_view(each->Name()).find(':') == std::string_view::npos) set(item, each->Name());
    std::set<std::string> seen;
    for (const XMLElement* child = item.element->FirstChildElement(); child != nullptr;
         child = child->NextSiblingElement())
      if (seen.insert(child->Name()).second) set(item, child->Name());
  }

  void set(const Item& item, const std::string& name) {
    if (unset_.contains({item.id, name})) return;
    const std::optional<Feature> feature = item.structure.type().find_feature(name);
    if (!feature)
      return leave_out(fmt::format("type {} has no feature '{}'", item.structure.type().name(), name),
                       item.place);
    try {
      set(item, *feature, values(*item.element, name));
    } catch (const Error& error) {
      if (!error.location().file.empty()) throw;
      throw Error(error.message(), item.place, error.hint());
    }
  }

  void set(const Item& item, Feature feature, const Values& given) {
    const FeatureStructure& structure = item.structure;
    const Type range = feature.range();
    const std::string& text = given.texts.front();
    const FileLocation& place = item.place;
    if (range.kind() == Kind::kBoolean) return structure.set(feature, bool_from(text, place));
    if (is_integer(range.kind())) return structure.set(feature, number_from<int64_t>(text, place));
    if (range.kind() == Kind::kFloat) return structure.set(feature, number_from<float>(text, place));
    if (range.kind() == Kind::kDouble) return structure.set(feature, number_from<double>(text, place));
    if (range.kind() == Kind::kString)
      return structure.set(feature, noted_text(text, item.id, feature.name(), 0));
    const auto component = system_.list_component(range);
    const bool is_array = range.kind() == Kind::kArray;
    const bool is_value = !feature.multiple_references_allowed() && (is_array || component) &&
                          !system_.list_component(structure.type());
    if (!is_value) return structure.set(feature, reference(text, place));
    if (!is_array) return structure.set(feature, list(*component, given, item.id, feature.name(), place));
    structure.set(feature, range.component_kind() == Kind::kStructure
                               ? cas_.create_array(references(given, place))
                               : array(range.component_kind(), given, item.id, feature.name(), place));
  }

  void read_view(const XMLElement& element) {
    const FileLocation place = place_of(element);
    const char* sofa = element.Attribute("sofa");
    if (sofa != nullptr && !views_.contains(sofa))
      throw Error(fmt::format("a view refers to sofa {}, which is not there", sofa), place);
    View& view = cas_.view(sofa == nullptr ? kInitialView : views_.at(sofa));
    for (const FeatureStructure& member : references(values(element, "members"), place))
      if (member) view.add_to_index(member);
  }

  Cas& cas_;
  const TypeSystem& system_;
  std::string file_;
  XmiOptions options_;
  Warnings& warnings_;
  std::map<std::string, std::string> spaces_;  ///< URI by prefix
  std::map<std::string, FeatureStructure> made_;
  std::set<std::string> dropped_;  ///< ids of what the type system does not know
  std::vector<Item> items_;
  std::map<std::string, std::string> views_;  ///< name by id of the sofa
  std::vector<const XMLElement*> view_elements_;
  std::set<std::pair<std::string, std::string>> unset_;
  std::set<std::string> no_view_;
  std::map<std::string, std::string> view_names_, no_sofa_;
  std::vector<std::array<std::string, 3>> references_;
  std::map<std::array<std::string, 3>, std::string> texts_;
};

}  // namespace

void from_xmi(Cas& cas, std::string_view xml, const std::string& file, const XmiOptions& options,
              Warnings& warnings) {
  if (cas.size() > 0 || !cas.view_names().empty()) throw Error("XMI is read into an empty CAS");
  XmiReader(cas, file, options, warnings).read(xml);
}

}  // namespace loci::perception::cas
