#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "mapping/base/text/base64.h"
#include "perception/cas/graph.h"
#include "perception/cas/xmi.h"
#include "perception/cas/xmi_text.h"

namespace loci::perception::cas {
namespace {

template <typename T>
std::string number_text(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) return "NaN";
    if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
  }
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

void append_word(std::string& text, const std::string& word) {
  if (!text.empty()) text += ' ';
  text += word;
}

template <typename T>
std::string joined(const RawBuffer& raw) {
  std::string text;
  for (const T& value : raw.as<T>()) {
    if (!text.empty()) text += ' ';
    if constexpr (std::is_same_v<T, bool>)
      text += value ? "true" : "false";
    else
      text += number_text(value);
  }
  return text;
}

/// Elements of an array of numbers as an attribute: separated by blanks, bytes in hexadecimal.
std::string elements_text(Kind kind, const RawBuffer& raw) {
  std::string text;
  switch (kind) {
    case Kind::kByte:
      for (const uint8_t byte : raw.as<uint8_t>()) text += fmt::format("{:02X}", byte);
      return text;
    case Kind::kBoolean:
      return joined<bool>(raw);
    case Kind::kShort:
      return joined<int16_t>(raw);
    case Kind::kInteger:
      return joined<int32_t>(raw);
    case Kind::kLong:
      return joined<int64_t>(raw);
    case Kind::kFloat:
      return joined<float>(raw);
    default:
      return joined<double>(raw);
  }
}

/// Prefixes of name spaces, which stand for packages.
class Prefixes {
 public:
  std::string element_name(const std::string& type) {
    const size_t dot = type.rfind('.');
    const std::string package = dot == std::string::npos ? "" : type.substr(0, dot);
    return prefix_of(package) + ":" + (dot == std::string::npos ? type : type.substr(dot + 1));
  }

  std::string declarations() const {
    std::string text;
    for (const auto& [package, prefix] : prefixes_) {
      std::string path = package.empty() ? "noNamespace" : package;
      std::replace(path.begin(), path.end(), '.', '/');
      if (package.empty()) path = "uima/noNamespace";
      text += fmt::format(" xmlns:{}=\"http:///{}.ecore\"", prefix, path);
    }
    return text;
  }

 private:
  const std::string& prefix_of(const std::string& package) {
    const auto found = prefixes_.find(package);
    if (found != prefixes_.end()) return found->second;
    const std::string last = package.empty() ? "noNamespace" : package.substr(package.rfind('.') + 1);
    std::string prefix = last;
    for (int i = 2; used_.contains(prefix); ++i) prefix = last + std::to_string(i);
    used_.insert(prefix);
    return prefixes_.emplace(package, prefix).first->second;
  }

  std::map<std::string, std::string> prefixes_ = {{"uima.cas", "cas"}};
  std::set<std::string> used_ = {"cas", "xmi", "xsi", "xml", "xmlns"};
};

class XmiWriter {
 public:
  explicit XmiWriter(const Cas& cas) : system_(cas.type_system()), views_(canonical_views(cas)) {
    std::vector<FeatureStructure> roots;
    for (const CanonicalView& view : views_) {
      if (view.sofa) roots.push_back(view.sofa);
      roots.insert(roots.end(), view.members.begin(), view.members.end());
    }
    all_ = reachable_from(roots);
    for (const FeatureStructure& root : roots) ++references_[root.id()];
    for (const FeatureStructure& each : all_)
      for_each_reference(each, [&](Feature, const FeatureStructure& target) { ++references_[target.id()]; });
    find_inlined();
    for (const FeatureStructure& each : all_)
      if (!inlined_.contains(each.id())) ids_.emplace(each.id(), ++last_id_);
  }

  std::string text() {
    number_sofas();
    for (const FeatureStructure& each : all_)
      if (!inlined_.contains(each.id())) write(each);
    for (const CanonicalView& view : views_) write_view(view);
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + notes_ +
           "<xmi:XMI xmlns:xmi=\"http://www.omg.org/XMI\"" + prefixes_.declarations() +
           " xmi:version=\"2.0\">\n  <cas:NULL xmi:id=\"0\"/>\n" + body_ + "</xmi:XMI>\n";
  }

 private:
  /// Nodes of a list from its first to its empty one; empty when it does not end in one, holds a node without
  /// head, or comes back to itself.
  std::vector<FeatureStructure> nodes_of(const FeatureStructure& list, Kind component) const {
    const TypeSystem::ListTypes& types = system_.list_types(component);
    std::vector<FeatureStructure> nodes;
    std::set<uint32_t> seen;
    for (FeatureStructure at = list; at && !at.is_deleted() && seen.insert(at.id()).second;
         at = at.get<FeatureStructure>("tail")) {
      nodes.push_back(at);
      if (at.type() == types.empty) return nodes;
      if (at.type() != types.node || (!at.is_set("head") && component != Kind::kStructure)) return {};
    }
    return {};
  }

  /// Arrays and lists stand inside a feature that allows one reference only.
  static bool is_value(Feature feature) {
    return feature && !feature.multiple_references_allowed() && feature.owner().name() != "uima.cas.Sofa";
  }

  void find_inlined() {
    for (const FeatureStructure& each : all_)
      for_each_reference(each, [&](Feature feature, const FeatureStructure& target) {
        if (!is_value(feature) || system_.list_component(each.type())) return;
        if (feature.range().kind() == Kind::kArray) {
          if (references_.at(target.id()) == 1) inlined_.insert(target.id());
        } else if (const auto component = system_.list_component(feature.range())) {
          const std::vector<FeatureStructure> nodes = nodes_of(target, *component);
          const bool alone = std::all_of(nodes.begin(), nodes.end(), [&](const FeatureStructure& node) {
            return references_.at(node.id()) == 1;
          });
          if (alone)
            for (const FeatureStructure& node : nodes) inlined_.insert(node.id());
        }
      });
  }

  void number_sofas() {
    std::set<int64_t> taken = {1};
    for (const FeatureStructure& each : all_)
      if (each.type().name() == "uima.cas.Sofa" && each.is_set("sofaNum"))
        taken.insert(each.get<int64_t>("sofaNum"));
    for (CanonicalView& view : views_) {
      if (!view.sofa && view.name == kInitialView) continue;
      int64_t number = 1;
      if (view.name != kInitialView)
        while (taken.contains(number)) ++number;
      taken.insert(number);
      numbers_[view.name] = number;
    }
  }

  std::string id_text(const FeatureStructure& target) const {
    return target.is_null() || target.is_deleted() ? "0" : std::to_string(ids_.at(target.id()));
  }

  std::string list_text(const std::vector<FeatureStructure>& elements) const {
    std::string text;
    for (const FeatureStructure& each : elements) append_word(text, id_text(each));
    return text;
  }

  void note(const std::string& text) { notes_ += "<?loci " + text + "?>\n"; }

  /// Text of a feature; what XML cannot hold is noted whole.
  std::string safe(const std::string& text, size_t id, const std::string& feature, size_t index) {
    if (xml_loses(text)) note(fmt::format("text {} {} {} {}", id, feature, index, base64_from_bytes(text)));
    return xml_text(text);
  }

  struct Element {
    size_t id;
    std::string attributes, children;
    void attribute(const std::string& name, const std::string& value) {
      attributes += fmt::format(" {}=\"{}\"", name, value);
    }
  };

  void add_texts(Element& element, const std::string& name, const std::vector<std::string>& texts) {
    if (texts.empty()) element.attribute(name, "");
    for (size_t i = 0; i < texts.size(); ++i)
      element.children += fmt::format("    <{0}>{1}</{0}>\n", name, safe(texts[i], element.id, name, i));
  }

  void add_array(Element& element, const std::string& name, const FeatureStructure& array) {
    const Kind kind = array.type().component_kind();
    if (kind == Kind::kStructure) {
      element.attribute(name, list_text(array.structures()));
    } else if (kind == Kind::kString) {
      const Buffer<std::string> texts = array.elements<std::string>();
      add_texts(element, name, {texts.begin(), texts.end()});
    } else {
      element.attribute(name, elements_text(kind, array.raw_elements(kind)));
    }
  }

  void add_list(Element& element, const std::string& name, const FeatureStructure& list, Kind component) {
    std::vector<FeatureStructure> nodes = nodes_of(list, component);
    if (nodes.empty()) return;
    nodes.pop_back();
    std::vector<std::string> values;
    std::string text;
    for (const FeatureStructure& node : nodes) {
      const Feature head = node.feature("head");
      if (component == Kind::kString)
        values.push_back(node.get<std::string>(head));
      else
        append_word(text, component == Kind::kStructure ? id_text(node.get<FeatureStructure>(head))
                          : component == Kind::kInteger ? number_text(node.get<int32_t>(head))
                                                        : number_text(node.get<float>(head)));
    }
    if (component == Kind::kString)
      add_texts(element, name, values);
    else
      element.attribute(name, text);
  }

  void add_reference(Element& element, const FeatureStructure& owner, Feature feature) {
    const FeatureStructure target = owner.get<FeatureStructure>(feature);
    if (target.is_null() || target.is_deleted()) return;
    const auto component = system_.list_component(feature.range());
    const bool is_array = feature.range().kind() == Kind::kArray;
    if (!is_value(feature) || (!is_array && !component) || system_.list_component(owner.type()))
      return element.attribute(feature.name(), id_text(target));
    if (is_array)
      add_array(element, feature.name(), target);
    else
      add_list(element, feature.name(), target, *component);
    if (!inlined_.contains(target.id()))
      note(fmt::format("reference {} {} {}", element.id, feature.name(), id_text(target)));
  }

  void add_feature(Element& element, const FeatureStructure& owner, Feature feature) {
    const Value& value = owner.value(feature);
    if (const bool* flag = std::get_if<bool>(&value))
      element.attribute(feature.name(), *flag ? "true" : "false");
    else if (const int64_t* number = std::get_if<int64_t>(&value))
      element.attribute(feature.name(), number_text(*number));
    else if (const double* real = std::get_if<double>(&value))
      element.attribute(feature.name(), feature.range().kind() == Kind::kFloat
                                            ? number_text(static_cast<float>(*real))
                                            : number_text(*real));
    else if (const std::string* text = std::get_if<std::string>(&value))
      element.attribute(feature.name(), safe(*text, element.id, feature.name(), 0));
    else if (std::holds_alternative<Reference>(value))
      add_reference(element, owner, feature);
  }

  void write(const FeatureStructure& each) {
    Element element{ids_.at(each.id()), {}, {}};
    if (each.type().kind() == Kind::kArray) add_array(element, "elements", each);
    if (each.type().name() == "uima.cas.Sofa") complete_sofa(element, each);
    for (const Feature& feature : each.type().features()) add_feature(element, each, feature);
    put(prefixes_.element_name(each.type().name()), element);
  }

  void put(const std::string& name, const Element& element) {
    body_ += fmt::format("  <{} xmi:id=\"{}\"{}", name, element.id, element.attributes);
    body_ += element.children.empty() ? "/>\n" : fmt::format(">\n{}  </{}>\n", element.children, name);
  }

  /// UIMA insists on numbers and names of sofas, and takes each for a view.
  void complete_sofa(Element& element, const FeatureStructure& sofa) {
    const auto view = std::find_if(views_.begin(), views_.end(),
                                   [&](const CanonicalView& each) { return each.sofa == sofa; });
    const bool adopted = view != views_.end();
    if (!sofa.is_set("sofaNum")) {
      element.attribute("sofaNum",
                        std::to_string(adopted ? numbers_.at(view->name) : 1000 + int64_t(element.id)));
      note(fmt::format("unset {} sofaNum", element.id));
    }
    if (!sofa.is_set("sofaID")) {
      element.attribute("sofaID", adopted ? xml_text(view->name) : fmt::format("sofa_{}", element.id));
      note(fmt::format("unset {} sofaID", element.id));
    }
    if (!adopted)
      note(fmt::format("no-view {}", element.id));
    else if (sofa.get<std::string>("sofaID") != view->name)
      note(fmt::format("view {} {}", element.id, base64_from_bytes(view->name)));
  }

  void write_view(const CanonicalView& view) {
    std::string sofa;
    if (view.sofa) {
      sofa = fmt::format(" sofa=\"{}\"", id_text(view.sofa));
    } else if (view.name != kInitialView) {
      Element element{++last_id_, {}, {}};
      element.attribute("sofaNum", std::to_string(numbers_.at(view.name)));
      element.attribute("sofaID", xml_text(view.name));
      put("cas:Sofa", element);
      note(fmt::format("no-sofa {} {}", element.id, base64_from_bytes(view.name)));
      sofa = fmt::format(" sofa=\"{}\"", element.id);
    }
    body_ += fmt::format("  <cas:View{} members=\"{}\"/>\n", sofa, list_text(view.members));
  }

  const TypeSystem& system_;
  std::vector<CanonicalView> views_;
  std::vector<FeatureStructure> all_;
  std::unordered_map<uint32_t, size_t> references_, ids_;
  std::set<uint32_t> inlined_;
  std::map<std::string, int64_t> numbers_;  ///< of the sofas of views
  size_t last_id_ = 0;
  Prefixes prefixes_;
  std::string body_, notes_;
};

}  // namespace

std::string to_xmi(const Cas& cas) {
  return XmiWriter(cas).text();
}

}  // namespace loci::perception::cas
