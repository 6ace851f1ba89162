#include "memory/questions/reply.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/json.h"
#include "memory/questions/answer_format.h"

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

Reply Answer::reply(const ReplyContext& context) const {
  Reply reply;
  if (!model_->write_reply(context, reply)) shorten(to_text(context.times), reply);
  if (!reply.text.empty() && reply.text[0] >= 'a' && reply.text[0] <= 'z' &&
      !reply.text.starts_with("object_"))
    reply.text[0] = static_cast<char>(reply.text[0] - 'a' + 'A');
  reply.text = shortened(reply.text);
  if (reply.evidence.size() > kMaxEvidenceLines) reply.evidence.resize(kMaxEvidenceLines);
  for (std::string& line : reply.evidence) line = shortened(line, 2 * kMaxReplyLength);
  return reply;
}

std::string to_text(const Reply& reply) {
  std::string text = reply.text + "\n";
  for (const std::string& line : reply.evidence) text += "  " + line + "\n";
  return text;
}

Json to_json(const Reply& reply) {
  Json json = {{"text", reply.text}, {"evidence", reply.evidence}};
  if (reply.verdict) json["verdict"] = to_text(*reply.verdict);
  if (reply.number) json["number"] = *reply.number;
  if (reply.probability) json["probability"] = *reply.probability;
  if (reply.duration) json["seconds"] = static_cast<double>(*reply.duration) / kSecond;
  if (reply.time) json["time"] = {format_time(reply.time->first), format_time(reply.time->last)};
  if (!reply.places.empty()) json["places"] = reply.places;
  for (const Id object : reply.objects) json["objects"].push_back(object_name(object));
  if (reply.not_known) json["not_known"] = true;
  return json;
}

}  // namespace loci::memory
