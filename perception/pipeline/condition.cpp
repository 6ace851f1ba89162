#include "perception/pipeline/condition.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <functional>
#include <optional>
#include <sstream>
#include <variant>

#include "mapping/base/text/text.h"

namespace loci::perception {

/// `and`, `or`, `not` over tests.
struct Condition::Node {
  enum class Kind { kAnd, kOr, kNot, kTest };
  Kind kind = Kind::kTest;
  std::vector<std::shared_ptr<const Node>> parts;
  // Of a test:
  std::string type;
  std::vector<std::string> path;
  std::string comparison;  ///< empty = is there one
  std::variant<double, bool, std::string> literal;
};

namespace {

using Literal = std::variant<double, bool, std::string>;

template <class T>
bool compares(const T& value, const std::string& comparison, const T& literal) {
  if (comparison == "==") return value == literal;
  if (comparison == "!=") return value != literal;
  if (comparison == "<") return value < literal;
  if (comparison == "<=") return value <= literal;
  if (comparison == ">") return value > literal;
  return value >= literal;
}

/// As other values, and `~`: whether the literal is a part of the text, in any case.
bool text_compares(const std::string& text, const std::string& comparison, const std::string& literal) {
  if (comparison == "~") return lower_case(text).find(lower_case(literal)) != std::string::npos;
  return compares(text, comparison, literal);
}

bool is_word(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.';
}

/// What a feature's values are compared with: a number, a flag or a text.
enum class Comparable { kNumber, kFlag, kText };

std::optional<Comparable> comparable(cas::Type range) {
  switch (range.kind()) {
    case cas::Kind::kBoolean:
      return Comparable::kFlag;
    case cas::Kind::kString:
      return Comparable::kText;
    case cas::Kind::kStructure:
      return std::nullopt;
    case cas::Kind::kArray:
      return range.component_kind() == cas::Kind::kString ? Comparable::kText : Comparable::kNumber;
    default:
      return Comparable::kNumber;
  }
}

bool value_fits(const cas::FeatureStructure& owner, cas::Feature feature, const std::string& comparison,
                const Literal& literal) {
  if (!owner.is_set(feature)) return comparison == "!=";
  const cas::Type range = feature.range();
  if (range.kind() == cas::Kind::kBoolean)
    return compares(owner.get<bool>(feature), comparison, std::get<bool>(literal));
  if (range.kind() == cas::Kind::kString)
    return text_compares(owner.text(feature), comparison, std::get<std::string>(literal));
  if (cas::is_floating(range.kind()))
    return compares(owner.get<double>(feature), comparison, std::get<double>(literal));
  if (cas::is_integer(range.kind()))
    return compares(static_cast<double>(owner.get<int64_t>(feature)), comparison, std::get<double>(literal));
  const cas::FeatureStructure array = owner.get<cas::FeatureStructure>(feature);
  if (range.component_kind() != cas::Kind::kString)
    return compares(static_cast<double>(array.array_size()), comparison, std::get<double>(literal));
  const cas::Buffer<std::string> texts = array.elements<std::string>();
  const auto fits = [&](const std::string& text) {
    return text_compares(text, comparison, std::get<std::string>(literal));
  };
  return comparison == "!=" ? std::all_of(texts.begin(), texts.end(), fits)
                            : std::any_of(texts.begin(), texts.end(), fits);
}

bool path_fits(const cas::FeatureStructure& start, const std::vector<std::string>& path,
               const std::string& comparison, const Literal& literal) {
  cas::FeatureStructure at = start;
  for (size_t i = 0; i + 1 < path.size(); ++i) {
    at = at.get<cas::FeatureStructure>(path[i]);
    if (!at) return comparison == "!=";
  }
  if (comparison.empty()) return at.is_set(path.back());
  return value_fits(at, at.feature(path.back()), comparison, literal);
}

}  // namespace

cas::Type named_type(const cas::TypeSystem& types, const std::string& name, const FileLocation& place) {
  if (const auto found = types.find(name)) return *found;
  std::vector<std::string> known;
  for (const std::string& sought : {name, name + "Annotation"})
    for (const cas::Type type : types.types()) {
      if (type.short_name() == sought) return type;
      known.push_back(type.short_name());
    }
  throw Error(fmt::format("there is no type '{}'", name), place, did_you_mean(name, known));
}

/// Levels of parentheses and `not`: recursion follows them.
constexpr int kMaxConditionDepth = 100;

/// Recursive descent over: or := and {"or" and}; and := not {"and" not}; not := ["not"] (test | "(" or ")").
class Condition::Parser {
 public:
  Parser(const std::string& text, const FileLocation& place) : text_(text), place_(place) { next(); }

  std::shared_ptr<const Node> run() {
    auto node = either();
    if (!token_.empty()) fail("'and', 'or' or the end");
    return node;
  }

 private:
  using NodePtr = std::shared_ptr<const Node>;

  NodePtr either() {
    return chain("or", Node::Kind::kOr, [this] { return both(); });
  }
  NodePtr both() {
    return chain("and", Node::Kind::kAnd, [this] { return negation(); });
  }

  NodePtr chain(const char* word, Node::Kind kind, const std::function<NodePtr()>& part) {
    std::vector<NodePtr> parts = {part()};
    while (token_ == word && !quoted_) {
      next();
      parts.push_back(part());
    }
    if (parts.size() == 1) return parts[0];
    auto node = std::make_shared<Node>();
    node->kind = kind;
    node->parts = std::move(parts);
    return node;
  }

  NodePtr negation() {
    const Level level(*this);
    if (token_ == "not" && !quoted_) {
      next();
      auto node = std::make_shared<Node>();
      node->kind = Node::Kind::kNot;
      node->parts = {negation()};
      return node;
    }
    if (token_ != "(") return test();
    next();
    NodePtr inner = either();
    if (token_ != ")") fail("')'");
    next();
    return inner;
  }

  NodePtr test() {
    if (token_.empty() || quoted_ || std::isalpha(static_cast<unsigned char>(token_[0])) == 0)
      fail("Type or Type.feature");
    auto node = std::make_shared<Node>();
    // A full name has its name space, in small letters, before the type.
    std::vector<std::string> parts;
    std::stringstream rest(token_);
    for (std::string part; std::getline(rest, part, '.');) parts.push_back(part);
    const auto is_space = [](const std::string& part) {
      return !part.empty() && std::islower(static_cast<unsigned char>(part[0])) != 0;
    };
    auto type = std::find_if_not(parts.begin(), parts.end(), is_space);
    if (type == parts.end()) type = parts.begin();
    node->type = fmt::format("{}", fmt::join(parts.begin(), type + 1, "."));
    node->path.assign(type + 1, parts.end());
    next();
    static const std::vector<std::string> kComparisons = {"==", "!=", "<", "<=", ">", ">=", "~"};
    if (quoted_ || std::find(kComparisons.begin(), kComparisons.end(), token_) == kComparisons.end())
      return node;
    if (node->path.empty()) fail("'and', 'or' or the end: a type alone is not compared");
    node->comparison = token_;
    next();
    node->literal = literal();
    next();
    return node;
  }

  Literal literal() {
    if (quoted_) return token_;
    if (token_ == "true") return true;
    if (token_ == "false") return false;
    char* end = nullptr;
    const double number = std::strtod(token_.c_str(), &end);
    if (token_.empty() || *end != '\0') fail("a number, true, false or a text in quotes");
    return number;
  }

  void next() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
    begin_ = at_;
    quoted_ = false;
    token_.clear();
    if (at_ == text_.size()) return;
    const char c = text_[at_];
    if (c == '"' || c == '\'') {
      const size_t close = text_.find(c, at_ + 1);
      if (close == std::string::npos) fail("the closing quote");
      token_ = text_.substr(at_ + 1, close - at_ - 1);
      quoted_ = true;
      at_ = close + 1;
      return;
    }
    if (is_word(c) || c == '-' || c == '+') {
      do ++at_;
      while (at_ < text_.size() && (is_word(text_[at_]) || (text_[at_] == '-' && text_[at_ - 1] == 'e')));
    } else {
      at_ += at_ + 1 < text_.size() && text_[at_ + 1] == '=' ? 2 : 1;
    }
    token_ = text_.substr(begin_, at_ - begin_);
  }

  /// One level of the recursion while it exists.
  class Level {
   public:
    explicit Level(Parser& parser) : parser_(parser) {
      if (++parser_.depth_ > kMaxConditionDepth)
        throw Error(fmt::format("the condition is more than {} levels deep", kMaxConditionDepth),
                    parser_.place_, "leave out parentheses that change nothing");
    }
    ~Level() { --parser_.depth_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;

   private:
    Parser& parser_;
  };

  [[noreturn]] void fail(const std::string& expected) const {
    throw Error(fmt::format("'{}' is no condition: at '{}'", text_, text_.substr(begin_)), place_,
                "expected " + expected);
  }

  const std::string& text_;
  const FileLocation& place_;
  size_t at_ = 0;
  size_t begin_ = 0;
  std::string token_;
  bool quoted_ = false;
  int depth_ = 0;
};

Condition Condition::parse(const std::string& text, const FileLocation& place) {
  Condition condition;
  condition.text_ = text;
  condition.place_ = place;
  condition.root_ = Parser(text, place).run();
  return condition;
}

std::vector<std::string> Condition::types() const {
  std::vector<std::string> types;
  const std::function<void(const Node&)> visit = [&](const Node& node) {
    for (const auto& part : node.parts) visit(*part);
    if (node.kind == Node::Kind::kTest) types.push_back(node.type);
  };
  visit(*root_);
  return types;
}

bool Condition::about_scene() const {
  const std::vector<std::string> all = types();
  return std::all_of(all.begin(), all.end(), [](const std::string& type) {
    return type == "Scene" || type == types::Scene::kTypeName;
  });
}

namespace {

cas::Feature named_feature(cas::Type type, const std::string& name, const FileLocation& place) try {
  return type.feature(name);
} catch (const Error& error) {
  throw Error(error.message(), place, error.hint());
}

}  // namespace

void Condition::check(const cas::TypeSystem& types) const {
  const std::function<void(const Node&)> visit = [&](const Node& node) {
    for (const auto& part : node.parts) visit(*part);
    if (node.kind != Node::Kind::kTest) return;
    cas::Type type = named_type(types, node.type, place_);
    for (size_t i = 0; i < node.path.size(); ++i) {
      const cas::Feature feature = named_feature(type, node.path[i], place_);
      type = feature.range();
      if (i + 1 < node.path.size()) continue;
      const std::optional<Comparable> kind = comparable(type);
      if (node.comparison.empty()) continue;
      if (!kind)
        throw Error(fmt::format("'{}' is a {}, which cannot be compared", feature.name(), type.name()),
                    place_, "go on to a feature of it");
      static const char* const kNames[] = {"a number", "true or false", "a text"};
      if (static_cast<size_t>(*kind) != node.literal.index())
        throw Error(fmt::format("'{}' is compared with {}, not with {}", feature.name(),
                                kNames[static_cast<size_t>(*kind)], kNames[node.literal.index()]),
                    place_);
      if (node.comparison == "~" && *kind != Comparable::kText)
        throw Error(fmt::format("'{}' is no text that '~' could look into", feature.name()), place_);
    }
  };
  visit(*root_);
}

bool Condition::holds(const types::SceneCas& scene, const types::Cluster& cluster) const {
  const cas::TypeSystem& types = scene.cas().type_system();
  const auto candidates = [&](const Node& test) {
    std::vector<cas::FeatureStructure> found;
    const cas::Type type = named_type(types, test.type, place_);
    const auto consider = [&](const cas::FeatureStructure& each) {
      if (each && !each.is_deleted() && cas::is_a(each.type(), type)) found.push_back(each);
    };
    consider(scene.scene());
    if (!cluster) return found;
    consider(cluster);
    consider(cluster.support.get());
    for (const types::Annotation& annotation : cluster.annotations) consider(annotation);
    for (const types::ObjectHypothesis& hypothesis : cluster.hypotheses) consider(hypothesis);
    return found;
  };
  const std::function<bool(const Node&)> holds = [&](const Node& node) {
    const auto part_holds = [&](const auto& part) { return holds(*part); };
    switch (node.kind) {
      case Node::Kind::kAnd:
        return std::all_of(node.parts.begin(), node.parts.end(), part_holds);
      case Node::Kind::kOr:
        return std::any_of(node.parts.begin(), node.parts.end(), part_holds);
      case Node::Kind::kNot:
        return !holds(*node.parts[0]);
      case Node::Kind::kTest:
        break;
    }
    const std::vector<cas::FeatureStructure> found = candidates(node);
    if (node.path.empty()) return !found.empty();
    if (found.empty()) return node.comparison == "!=";
    return std::any_of(found.begin(), found.end(), [&](const cas::FeatureStructure& each) {
      return path_fits(each, node.path, node.comparison, node.literal);
    });
  };
  return holds(*root_);
}

}  // namespace loci::perception
