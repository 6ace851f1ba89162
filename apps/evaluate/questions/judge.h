#pragma once

#include <string>
#include <vector>

#include "apps/evaluate/questions/memories.h"
#include "apps/evaluate/questions/table.h"
#include "mapping/base/text/json_fwd.h"
#include "memory/sentences/natural_language.h"

namespace loci::apps::questions {

enum class Outcome {
  right,
  wrong,           ///< it states what is not so
  misleading,      ///< it answers another question than the one asked
  undecided,       ///< it says that it does not know, where the truth is known
  not_understood,  ///< it says so
};
std::string to_text(Outcome outcome);

struct JudgedAnswer {
  AskedQuestion asked = {};
  Outcome outcome = Outcome::right;
  std::string text = {};     ///< the reply
  std::string command = {};  ///< that was understood
  double ms = 0;             ///< of CPU time, from sentence to reply
};

JudgedAnswer judge(const AskedQuestion& asked, const memory::Store& store, const TrueNames& names,
                   const Twins& twins = {});

struct QuestionFigures {
  std::vector<JudgedAnswer> answers;
  size_t max_length() const;  ///< characters of the longest reply
  size_t max_lines() const;   ///< of evidence
};
std::string text_of(const QuestionFigures& figures, bool all);
Json json_of(const QuestionFigures& figures);

}  // namespace loci::apps::questions
