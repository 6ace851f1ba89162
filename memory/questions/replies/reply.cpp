#include "memory/questions/replies/reply.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "mapping/base/text/json.h"
#include "mapping/base/text/text.h"
#include "memory/questions/forgotten.h"
#include "memory/questions/replies/answer_fields.h"
#include "memory/questions/replies/answer_format.h"
#include "memory/questions/replies/reply_parts.h"

namespace loci::memory {
namespace {

/// Characters of UTF-8, not bytes.
size_t length_of(std::string_view text) {
  return static_cast<size_t>(
      std::ranges::count_if(text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// A text of many lines as a sentence and its evidence.
void shorten(const std::string& text, Reply& reply) {
  size_t begin = 0;
  while (begin < text.size() && reply.evidence.size() <= kMaxEvidenceLines) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    std::string line = trimmed(text.substr(begin, end - begin));
    begin = end + 1;
    if (line.empty()) continue;
    if (reply.text.empty())
      reply.text = line;
    else
      reply.evidence.push_back(std::move(line));
  }
}

/// "The tomatoes was" is "The tomatoes were": the verb agrees with the name before it.
std::string with_agreement(const std::string& text) {
  static const std::map<std::string, std::string, std::less<>> plurals = {
      {"is", "are"}, {"was", "were"}, {"has", "have"}, {"looks", "look"}, {"stands", "stand"}};
  std::string result;
  std::string_view before;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find(' ', begin), text.size());
    const std::string_view word = std::string_view(text).substr(begin, end - begin);
    const auto plural = plurals.find(word);
    result += plural != plurals.end() && replies::is_plural(before) ? plural->second : std::string(word);
    if (end < text.size()) result += ' ';
    before = word;
    begin = end + 1;
  }
  return result;
}

/// What is beyond the length of a reply's sentence begins its evidence, if a semicolon divides it.
void divide(Reply& reply) {
  if (length_of(reply.text) <= kMaxReplyLength) return;
  for (size_t at = reply.text.rfind("; "); at != std::string::npos && at > 0;
       at = reply.text.rfind("; ", at - 1)) {
    const std::string sentence = reply.text.substr(0, at) + ".";
    if (length_of(sentence) > kMaxReplyLength) continue;
    std::string rest = reply.text.substr(at + 2);
    if (rest.ends_with('.')) rest.pop_back();
    reply.evidence.insert(reply.evidence.begin(), std::move(rest));
    reply.text = sentence;
    return;
  }
}

Reply within_limits(Reply reply) {
  divide(reply);
  reply.text = shortened(reply.text);
  if (reply.evidence.size() > kMaxEvidenceLines) reply.evidence.resize(kMaxEvidenceLines);
  for (std::string& line : reply.evidence) line = shortened(with_agreement(line), 2 * kMaxReplyLength);
  return reply;
}

}  // namespace

std::string shortened(const std::string& text, size_t length) {
  if (length_of(text) <= length) return text;
  std::string cut;
  for (const std::string& word : words_of(text)) {
    if (length_of(cut) + 1 + length_of(word) + 4 > length) break;
    cut += (cut.empty() ? "" : " ") + word;
  }
  return cut + " ...";
}

std::string capitalised(std::string text) {
  if (!text.empty() && text[0] >= 'a' && text[0] <= 'z' && !text.starts_with("object_"))
    text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

std::string uncapitalised(std::string text) {
  if (!text.empty() && text[0] >= 'A' && text[0] <= 'Z') text[0] = static_cast<char>(text[0] - 'A' + 'a');
  return text;
}

Reply Answer::reply(const ReplyContext& context) const {
  const std::optional<ForgottenTime> forgotten = forgotten_time(context.store, context.query, context.as_of);
  if (!forgotten || !forgotten->all) return written(context);
  ReplyContext before = context;
  if (forgotten->before) before.as_of.at = forgotten->before;
  return within_limits(forgotten_reply(*forgotten, written(before), context.times));
}

Reply Answer::written(const ReplyContext& context) const {
  Reply reply;
  if (!model_->write_reply(context, reply)) shorten(to_text(context.times), reply);
  reply.text = with_agreement(capitalised(std::move(reply.text)));
  return within_limits(std::move(reply));
}

std::string headed(const Reply& reply, std::string text) {
  if (!text.starts_with(reply.text)) text.insert(0, reply.text + "\n");
  std::string notes;
  for (const std::string& note : reply.notes) notes += "  (" + note + ")\n";
  return text.insert(text.find('\n') + 1, notes);
}

std::string to_text(const Reply& reply) {
  std::string text = headed(reply, reply.text + "\n");
  for (const std::string& line : reply.evidence) text += "  " + line + "\n";
  return text;
}

namespace format {

const Record<Reply>& reply_record() {
  static const auto record =
      Record<Reply>("Reply")
          .value("text", &Reply::text)
          .value("evidence", &Reply::evidence)
          .value("notes", [](const Reply& reply) { return unless_empty(reply.notes); })
          .value("verdict", &Reply::verdict)
          .value("number", &Reply::number)
          .value("out_of_sight",
                 [](const Reply& reply) {
                   return reply.out_of_sight > 0 ? std::optional(reply.out_of_sight) : std::nullopt;
                 })
          .value("probability", &Reply::probability)
          .value("seconds",
                 [](const Reply& reply) {
                   return reply.duration ? std::optional(in_seconds(*reply.duration)) : std::nullopt;
                 })
          .value("time",
                 [](const Reply& reply) {
                   return reply.time
                              ? std::optional(std::vector<TimeText>{{reply.time->first}, {reply.time->last}})
                              : std::nullopt;
                 })
          .value("places", [](const Reply& reply) { return unless_empty(reply.places); })
          .value("objects",
                 [](const Reply& reply) {
                   std::vector<std::string> names;
                   for (const Id object : reply.objects) names.push_back(object_name(object));
                   return unless_empty(names);
                 })
          .value("not_known", [](const Reply& reply) { return if_true(reply.not_known); });
  return record;
}

}  // namespace format

Json to_json(const Reply& reply) {
  return format::reply_record().json(reply);
}

}  // namespace loci::memory
