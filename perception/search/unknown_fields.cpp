#include "perception/search/unknown_fields.h"

#include <fmt/format.h>
#include <google/protobuf/message.h>
#include <google/protobuf/unknown_field_set.h>

#include <algorithm>

namespace loci::perception {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::UnknownField;
using google::protobuf::UnknownFieldSet;

constexpr size_t kShownText = 60;

bool is_printable(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
}

void list(const UnknownFieldSet& fields, const std::string& path, std::vector<std::string>& lines);

void list_bytes(const std::string& bytes, const std::string& path, std::vector<std::string>& lines) {
  if (!bytes.empty() && is_printable(bytes)) {
    const std::string shown = bytes.size() <= kShownText ? bytes : bytes.substr(0, kShownText) + "…";
    lines.push_back(fmt::format("{}: text '{}'", path, shown));
    return;
  }
  UnknownFieldSet inner;
  if (!bytes.empty() && inner.ParseFromString(bytes))
    list(inner, path, lines);
  else
    lines.push_back(fmt::format("{}: {} bytes", path, bytes.size()));
}

void list(const UnknownFieldSet& fields, const std::string& path, std::vector<std::string>& lines) {
  for (int i = 0; i < fields.field_count(); ++i) {
    const UnknownField& field = fields.field(i);
    const std::string name =
        path.empty() ? std::to_string(field.number()) : fmt::format("{}.{}", path, field.number());
    switch (field.type()) {
      case UnknownField::TYPE_VARINT:
        lines.push_back(fmt::format("{}: varint {}", name, field.varint()));
        break;
      case UnknownField::TYPE_FIXED32:
        lines.push_back(fmt::format("{}: fixed32 {}", name, field.fixed32()));
        break;
      case UnknownField::TYPE_FIXED64:
        lines.push_back(fmt::format("{}: fixed64 {}", name, field.fixed64()));
        break;
      case UnknownField::TYPE_LENGTH_DELIMITED:
        list_bytes(field.length_delimited(), name, lines);
        break;
      case UnknownField::TYPE_GROUP:
        list(field.group(), name, lines);
        break;
    }
  }
}

void list(const Message& message, const std::string& path, std::vector<std::string>& lines) {
  const auto* reflection = message.GetReflection();
  list(reflection->GetUnknownFields(message), path, lines);
  std::vector<const FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    const std::string name = (path.empty() ? "" : path + ".") + field->name();
    if (!field->is_repeated()) {
      list(reflection->GetMessage(message, field), name, lines);
      continue;
    }
    for (int i = 0; i < reflection->FieldSize(message, field); ++i)
      list(reflection->GetRepeatedMessage(message, field, i), fmt::format("{}[{}]", name, i), lines);
  }
}

}  // namespace

std::vector<std::string> structural_differences(const Message& message, std::string_view bytes) {
  const std::string again = message.SerializePartialAsString();
  std::vector<std::string> lines;
  list(message, "", lines);
  // Fields may come in any order, which does not change the length.
  if (again.size() != bytes.size())
    lines.push_back(fmt::format("encoded again it has {} bytes instead of {}", again.size(), bytes.size()));
  return lines;
}

}  // namespace loci::perception
