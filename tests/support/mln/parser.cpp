#include <algorithm>
#include <cctype>
#include <cmath>

#include "tests/support/mln/markov_logic.h"

namespace loci::mln {
namespace {

struct Token {
  enum class Kind { name, number, symbol, end };
  Kind kind = Kind::end;
  std::string text;
};

class Line {
 public:
  Line(std::string_view text, const std::string& file, int number) : file_(file), number_(number) {
    size_t at = 0;
    while (at < text.size()) {
      if (std::isspace(static_cast<unsigned char>(text[at]))) {
        ++at;
        continue;
      }
      if (text.substr(at, 2) == "//") break;
      tokens_.push_back(token(text.substr(at)));
      at += tokens_.back().text.size();
    }
  }

  bool empty() const { return tokens_.empty(); }
  const Token& peek(size_t ahead = 0) const {
    static const Token end;
    return next_ + ahead < tokens_.size() ? tokens_[next_ + ahead] : end;
  }
  bool take(std::string_view text) {
    if (peek().text != text) return false;
    ++next_;
    return true;
  }
  void expect(std::string_view text) {
    if (!take(text)) fail("expected '" + std::string(text) + "' " + here());
  }
  std::string name() {
    if (peek().kind != Token::Kind::name) fail("expected a name " + here());
    return tokens_[next_++].text;
  }
  std::optional<double> number() {
    const size_t sign = peek().text == "-" ? 1 : 0;
    if (peek(sign).kind != Token::Kind::number) return std::nullopt;
    const double value = std::stod(peek(sign).text);
    next_ += sign + 1;
    return sign == 1 ? -value : value;
  }
  void finish() {
    if (next_ < tokens_.size()) fail("did not understand the rest " + here());
  }
  [[noreturn]] void fail(const std::string& what) const { throw Error(what, {file_, number_, {}}); }
  int line() const { return number_; }
  bool has(std::string_view text) const {
    return std::any_of(tokens_.begin(), tokens_.end(), [&](const Token& t) { return t.text == text; });
  }
  const Token& last() const { return tokens_.back(); }

 private:
  std::string here() const {
    return peek().kind == Token::Kind::end ? "at the end of the line" : "at '" + peek().text + "'";
  }

  Token token(std::string_view rest) const {
    const auto run = [&](auto&& inside) {
      size_t size = 0;
      while (size < rest.size() && inside(static_cast<unsigned char>(rest[size]))) ++size;
      return std::string(rest.substr(0, size));
    };
    if (std::isdigit(static_cast<unsigned char>(rest[0]))) {
      std::string digits = run([](unsigned char c) { return std::isdigit(c) || c == '.' || c == 'e'; });
      if (digits.back() == '.') digits.pop_back();
      return {Token::Kind::number, digits};
    }
    if (std::isalpha(static_cast<unsigned char>(rest[0])) || rest[0] == '_')
      return {Token::Kind::name, run([](unsigned char c) { return std::isalnum(c) || c == '_'; })};
    for (const std::string_view symbol : {"<=>", "=>"})
      if (rest.starts_with(symbol)) return {Token::Kind::symbol, std::string(symbol)};
    if (std::string_view("(){},=!^.-").find(rest[0]) == std::string_view::npos)
      fail("unknown character '" + std::string(rest.substr(0, 1)) + "'");
    return {Token::Kind::symbol, std::string(rest.substr(0, 1))};
  }

  std::string file_;
  int number_;
  std::vector<Token> tokens_;
  size_t next_ = 0;
};

/// Recursive descent, loosest first: <=>, =>, v, ^, ! and EXIST, atoms.
class FormulaParser {
 public:
  FormulaParser(Line& line, const Network& network) : line_(line), network_(network) {}

  Formula formula() {
    Formula left = implication();
    while (line_.take("<=>")) left = join(Formula::Kind::equivalence, std::move(left), implication());
    return left;
  }

 private:
  Formula implication() {
    Formula left = disjunction();
    if (line_.take("=>")) return join(Formula::Kind::implication, std::move(left), implication());
    return left;
  }
  Formula disjunction() {
    Formula left = conjunction();
    while (line_.take("v")) left = join(Formula::Kind::disjunction, std::move(left), conjunction());
    return left;
  }
  Formula conjunction() {
    Formula left = unary();
    while (line_.take("^")) left = join(Formula::Kind::conjunction, std::move(left), unary());
    return left;
  }
  Formula unary() {
    if (line_.take("!")) return {Formula::Kind::negation, {}, {}, {unary()}};
    if (line_.take("EXIST")) {
      Formula exists{Formula::Kind::exists, {}, {line_.name()}, {}};
      while (line_.take(",")) exists.terms.push_back(line_.name());
      exists.parts.push_back(unary());
      return exists;
    }
    if (line_.take("(")) {
      Formula inner = formula();
      line_.expect(")");
      return inner;
    }
    return atom();
  }
  Formula atom() {
    const std::string name = line_.name();
    if (line_.take("=")) return {Formula::Kind::equal, {}, {name, line_.name()}, {}};
    const Predicate* predicate = network_.find(name);
    if (predicate == nullptr) line_.fail("there is no predicate '" + name + "'");
    Formula atom{Formula::Kind::atom, name, {}, {}};
    line_.expect("(");
    do atom.terms.push_back(line_.name());
    while (line_.take(","));
    line_.expect(")");
    if (atom.terms.size() != predicate->domains.size())
      line_.fail("'" + name + "' takes " + std::to_string(predicate->domains.size()) + " arguments");
    return atom;
  }
  static Formula join(Formula::Kind kind, Formula left, Formula right) {
    return {kind, {}, {}, {std::move(left), std::move(right)}};
  }

  Line& line_;
  const Network& network_;
};

template <class Take>
void each_line(std::string_view text, const std::string& file, Take take) {
  int number = 0;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    Line line(text.substr(0, end), file, ++number);
    if (!line.empty()) take(line);
    text.remove_prefix(std::min(text.size(), end + 1));
  }
}

bool read_domain(Line& line, Network& network) {
  if (line.peek(1).text != "=" || line.peek(2).text != "{") return false;
  std::vector<std::string>& domain = network.domains[line.name()];
  line.expect("=");
  line.expect("{");
  do {
    const std::string constant = line.name();
    if (std::find(domain.begin(), domain.end(), constant) == domain.end()) domain.push_back(constant);
  } while (line.take(","));
  line.expect("}");
  line.finish();
  return true;
}

Predicate read_predicate(Line& line) {
  Predicate predicate{line.name(), {}, {}};
  line.expect("(");
  do {
    predicate.domains.push_back(line.name());
    if (!line.take("!")) continue;
    if (predicate.functional) line.fail("only one argument can be functional");
    predicate.functional = predicate.domains.size() - 1;
  } while (line.take(","));
  line.expect(")");
  line.finish();
  return predicate;
}

}  // namespace

const Predicate* Network::find(const std::string& name) const {
  const auto found = std::find_if(predicates.begin(), predicates.end(),
                                  [&](const Predicate& predicate) { return predicate.name == name; });
  return found == predicates.end() ? nullptr : &*found;
}

bool Network::is_constant(const std::string& name) const {
  return std::any_of(domains.begin(), domains.end(), [&](const auto& domain) {
    return std::find(domain.second.begin(), domain.second.end(), name) != domain.second.end();
  });
}

void Network::read(std::string_view text, const std::string& file) {
  each_line(text, file, [&](Line& line) {
    if (read_domain(line, *this)) return;
    const bool weighted = line.peek().kind == Token::Kind::number || line.peek().text == "-";
    if (!weighted && line.last().text != "." && find(line.peek().text) == nullptr) {
      predicates.push_back(read_predicate(line));
      return;
    }
    WeightedFormula formula;
    formula.line = line.line();
    if (const auto weight = line.number()) formula.weight = *weight;
    formula.formula = FormulaParser(line, *this).formula();
    formula.hard = !weighted;
    if (formula.hard) line.expect(".");
    line.finish();
    formulas.push_back(std::move(formula));
  });
}

void Network::read_evidence(std::string_view text, const std::string& file) {
  each_line(text, file, [&](Line& line) {
    if (read_domain(line, *this)) return;
    SoftEvidence given;
    given.line = line.line();
    if (const auto probability = line.number()) given.probability = *probability;
    if (line.take("!")) given.probability = 1 - given.probability;
    if (!(given.probability >= 0 && given.probability <= 1)) line.fail("a probability lies in [0,1]");
    const Formula atom = FormulaParser(line, *this).formula();
    line.finish();
    if (atom.kind != Formula::Kind::atom) line.fail("evidence is about one atom");
    for (const std::string& term : atom.terms)
      if (!is_constant(term)) line.fail("'" + term + "' is in no domain");
    given.predicate = atom.predicate;
    given.constants = atom.terms;
    evidence.push_back(std::move(given));
  });
}

}  // namespace loci::mln
