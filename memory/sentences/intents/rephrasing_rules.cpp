#include "memory/sentences/intents/rephrasing_rules.h"

namespace loci::memory {

const std::vector<Pattern>& meanings() {
  static const std::vector<Pattern> all = {
      {"have|has|had|would <x> by now", "have <x>"},
      {"^ what|which <x> on|in|at <p:name> together|along with <y:name> $",
       "what <x> on <p> when <y> was on <p>"},
      // "What was it that I put on the table?"
      {"what is|was it that? i|we|you had <x>", "what was <x>"},
      {"^ what is|was it that? i|we|you|someone|somebody <x>", "what did someone <x>"},
      {"^ where is|was it that? i|we|you|someone|somebody <x>", "where did someone <x>"},
      {"^ when is|was it that? i|we|you|someone|somebody <x>", "when did someone <x>"},
      {"what the|my|our? <p:name> has|holds|carries on it", "what is on the <p>"},
      // What is spoken of comes first: "the bottle where was that at ten".
      {"^ the|my|our <x:name> <q:asking> <y> it|that|they|them $", "<q> <y> the <x>"},
      {"^ the|my|our <x:name> <q:asking> <y> it|that|they|them <z>", "<q> <y> the <x> <z>"},
      {"^ the|my|our <x:name> ,? when did it|they last show up $", "when was the <x> last seen"},
      // What changed since then.
      {"^ what|anything is? different|changed from|than|to <t> $", "what changed since <t>"},
      {"^ is|are everything|all still? where|as it|they was|were <t> $", "was nothing moved since <t>"},
      {"^ does everything|it|the? kitchen|room? still? look the same as <t> $",
       "was nothing moved since <t>"},
      // The table, and of the past the meal.
      {"^ what|which is|are on the|our breakfast|lunch|dinner|supper table", "what is on the table"},
      {"^ is <x> the|our breakfast|lunch|dinner|supper table", "is <x> the table"},
      {"^ are <x> the|our breakfast|lunch|dinner|supper table", "are <x> the table"},
      {"the|our breakfast table $", "the table at breakfast"},
      {"the|our lunch table $", "the table at lunch"},
      {"the|our dinner|supper table $", "the table at dinner"},
      {"the|our breakfast|lunch|dinner|supper table", "the table"},
      // Of two the one with more.
      {"^ which|what <n:noun> has|have|had|holds|contains more things|objects|items|stuff on|in? it|them? $",
       "which <n> has the most objects"},
      {"^ which|what <n:noun> is fuller|busier $", "which <n> has the most objects"},
      {"^ how many objects|things|items was|were there? on|in|at|inside <p:name> at most|once $",
       "how many mostthings was <p>"},
      {"^ how many objects|things|items was|were there? on|in|at|inside <p:name> at most|once <t> $",
       "how many mostthings was <p> <t>"},
      {"^ what is|was the? most|maximum|highest|largest number|count? of? objects|things|items ever? "
       "on|in|at|inside <p:name> $",
       "how many mostthings was <p>"},
      {"^ what is|was the? most|maximum|highest|largest number|count? of? objects|things|items ever? "
       "on|in|at|inside <p:name> at one|any time|moment|once $",
       "how many mostthings was <p>"},
      {"^ what stood|was|lay|sat together|along with <y:name> on|in|at <p:name> <t> $",
       "what was on <p> <t> except <y>"},
      {"^ which|what <n:noun> was|were taken|moved|removed|cleared off|from <p:name> and brought|put|moved "
       "back later|again? $",
       "which <n> came back"},
      {"^ what was|were missing|gone from|on <p:name> at <t> that had|was|were still? been? there|here at "
       "<s> $",
       "what was on <p> at <s> that was gone at <t>"},
      {"^ which|what objects|things|items was|were missing|gone from|on <p:name> at <t> that had|was|were "
       "still? been? there|here at <s> $",
       "what was on <p> at <s> that was gone at <t>"},
      // Which one was moved: that on the counter.
      {"the|my <x:name> on|in|at <p:name> was not moved|touched|handled", "the <x> was not moved"},
      {"the|my <x:name> on|in|at <p:name> has not been moved|touched|handled", "the <x> was not moved"},
      {"^ was|has|were|have the|my <x:name> on|in|at <p:name> been? moved|touched|handled",
       "was the <x> moved"},
      // What was there then and is not now.
      {"^ what|which is|are not on|in|at <p:name> any? more|anymore that|which was|were there <t> $",
       "what was on <p> <t> that is gone now"},
      {"^ what|which is|are missing|gone from|on|in <p:name> compared with|to <t> $",
       "what was on <p> at <t> that is gone now"},
      {"^ what|which objects|items|things? was|were? present|here|there at? <t> that|and? is|are|has|have "
       "gone|vanished|disappeared|missing now? $",
       "what disappeared since <t>"},
      {"^ what|which objects|items|things? was|were? present|here|there at? <t> that|and? is|are not|no "
       "longer|more? present|here|there any? more|anymore|now? $",
       "what disappeared since <t>"},
      // What is there now and was not then.
      {"^ what|which <x> on|in|at <p:name> that|which was|were not there|here <t> $",
       "what newsince is on <p> <t>"},
      {"^ compared with|to <t> , what is|are new on|in|at <p:name> $", "what newsince is on <p> at <t>"},
      {"^ what is|are new on|in|at <p:name> compared with|to <t> $", "what newsince is on <p> at <t>"},
      {"^ <x:name> total|count|tally $", "how many <x>"},
      {"^ <x:name> on|in|at <p:name> , total|count|tally|number $", "how many <x> are on <p>"},
      // What was the last state that is asked about.
      {"^ the? last time that? <x> was|were open|opened ,? what was|were in it|them|there $",
       "what was in <x> when <x> was last opened"},
      {"^ which|what is|was closer|nearer to <y:name> , <a:name> or <b:name> $",
       "is <y> nearer to <a> or to <b>"},
      {"^ give|state|name|report|tell the? interval|period|time|window|moment during|in|at? which <x>",
       "when did <x>"},
      // Everything that something happened to.
      {"^ a? list|name|show|report|give|tell|print me|us? a? list? of? everything|anything that|which <x>",
       "what <x>"},
      {"^ a? list|name|show|report|give|tell|print me|us? a? list? of? all? the? objects|things|items "
       "that|which <x>",
       "what <x>"},
      {"^ a? list|name|show|report|give|tell|print me|us? a? list? of? everything|anything "
       "moved|touched|handled <x>",
       "what was moved <x>"},
      {"^ a? list|name|show|report|give|tell|print me|us? a? list? of? everything|anything "
       "put|placed|set|brought|added "
       "<x>",
       "what was put <x>"},
      {"^ a? list|name|show|report|give|tell|print me|us? a? list? of? everything|anything "
       "taken|removed|cleared <x>",
       "what was taken <x>"},
      {"^ what did|have you see|seen|notice|noticed last|recently|lately $",
       "what did you see in the last look"},
      {"^ what is|was the? last|latest object|thing|item|objects|things that? you saw|see|noticed $",
       "what did you see in the last look"},
      {"^ which|what <n:furniture> was <x> on|in|at before|previously|earlier $", "where was <x> before"},
      // Which one of that name: "the cup, the red one, where is it?"
      {"the|my <x:name> , the <c:colour> one , <z>", "the <c> <x> , <z>"},
      {"the|my <x:name> , the <c:colour> one $", "the <c> <x>"},
      {"the|my <x:name> , the one that? is? in|inside <p:name> , <z>", "the <x> in <p> , <z>"},
      {"the|my <x:name> , the one that? is? on|at <p:name> , <z>", "the <x> on <p> , <z>"},
      {"^ has|have <p:name> stayed|remained put", "was <p> never moved"},
      {"^ has|have <p:name> stayed|remained|been left? where it|they was|were $", "was <p> never moved"},
      {"^ has|have <p:name> stayed|remained|been left? where i|we|someone left|put it|them $",
       "was <p> never moved"},
      {"^ has|have <p:name> stayed|remained|been left? where i|we|someone left|put it|them at|in <t> $",
       "was <p> never moved since <t>"},
      // What is left out of what is asked about.
      {"^ never mind|ignoring|ignore|forget|disregarding <x:name> .|, what else? <y> $",
       "what <y> except <x>"},
      {"something|anything else|other than <x:name> on|at <p:name>", "anything on <p> except <x>"},
      {"something|anything else|other than <x:name> in|inside <p:name>", "anything in <p> except <x>"},
      {"^ did <p:name> stay|remain put", "was <p> never moved"},
      {"^ <x> , <c> included|including $", "<x>"},
      {"^ <x> , including <c:name> $", "<x>"},
      // Which of two did it more often.
      {"^ which|what <x> more|most often , <a:name> or <b:name> $", "which of <a> and <b> <x> most often"},
      {"^ which|what <x> earlier|sooner ,? <a:name> or <b:name> $", "which <x> first , <a> or <b>"},
      {"^ which|what <x> later ,? <a:name> or <b:name> $", "which <x> last , <a> or <b>"},
      // What has an own question.
      {"which|what <x:name> disappeared|vanished|left and|but came|returned back? $", "which <x> came back"},
      {"be seen|found right? now|currently", "be seen"},
      {"the|my|our dark <n:noun>", "the black <n>"},
      {"^ where should|could|can i|we look|search|check $", "where should i look for it"},
      {"^ since when do|have|had i|we have|had|got? a|an|any|some <x:name> $", "when was the <x> first seen"},
      {"^ since when is|are there a|an|any <x:name> $", "when was the <x> first seen"},
      {"^ from which|what <n:noun> did|has|had|was|were <x:name> been? "
       "come|came|taken|moved|brought|carried|fetched|go over? $",
       "where did <x> come from"},
      {"^ from where|whence did|has|had|was|were|is <x:name> been? "
       "come|came|coming|taken|moved|brought|carried|fetched over? $",
       "where did <x> come from"},
      {"^ which|what <n:noun> did|has|had|was|were <x:name> been? "
       "come|came|taken|moved|brought|carried|fetched from $",
       "where did <x> come from"},
      {"moved|handled|used|touched the? most $", "moved most often"},
      {"opened the? most $", "opened most often"},
      {"^ how many <n:noun> did someone|somebody|anyone|anybody|i|we|you|they see? open|opened $",
       "how many <n> were opened"},
      {"^ how many <n:noun> did someone|somebody|anyone|anybody|i|we|you|they see? open|opened <t> $",
       "how many <n> were opened <t>"},
      {"^ when was the? last time that? anything|something <x>", "when did something <x> last"},
      {"^ how long has|have|had|was|were <x:name> been? out $", "how long was <x> there"},
      {"^ next to|beside|near which object|objects|thing|things is|are|was|were <x:name> $",
       "what is next to <x>"},
      // A choice of places: where it is, or was.
      {"^ where do|can|could|should i|we find <x:name> , <p> or <q> $", "where is <x>"},
      {"^ where is|are <x:name> , <p> or <q> $", "where is <x>"},
      {"^ where was|were <x:name> <t> , <p> or <q> $", "where was <x> <t>"},
      {"^ was|were <x:name> in|on|at <a:name> or in|on|at? <b:name> <t> $", "where was <x> <t>"},
      // How much room there is nobody measures; what takes it up is known.
      {"^ is there still? any|enough|some? space|room left|free? on|at <p:name> $", "what is on <p>"},
      {"^ is there still? any|enough|some? space|room left|free? in|inside <p:name> $", "what is in <p>"},
      {"^ which|what place|places|surface|surfaces|spot|spots is|are empty|free|clear|unused $",
       "what furniture is empty"},
      {"^ has|have|was|were <x:name> ever? been? anywhere|somewhere else $", "where has <x> been"},
      // Telegrams.
      {"^ objects|things|items that|which <x>", "what <x>"},
      {"^ objects|things|items within <x>", "what is within <x>"},
      {"^ objects|things|items moved|touched|handled <x>", "what was moved <x>"},
      {"^ objects|things|items appeared|added <x>", "what appeared <x>"},
      {"^ gone|missing|vanished objects|things|items $", "what has gone"},
      {"how long <x> at most $", "how long <x>"},
      // A choice after a question that is complete without it.
      {"^ do|have i|we have? two|three|four <n:noun> or one|two|three|four|five $", "how many <n> are there"},
      {"^ are there two|three|four <n:noun> or one|two|three|four|five $", "how many <n> are there"},
      {"which|what of? the? two? <n:noun> is|was closer|nearer to <y> , the <a> one? or the <b> one $",
       "is <y> nearer to the <a> <n> or to the <b> <n>"},
      {"which|what of? the two <n:noun> is|was <v> , the <a> one or the <b> one $", "which <n> is <v>"},
      {"^ which|what <n:noun> <v> ,? the <a:colour> one? or the <b:colour> one? $",
       "which <a> <n> or <b> <n> <v>"},
      // Lists: of four, the last three first.
      {"<a:name> , <b:name> ,? and <c:name>", "<a> and <b> and <c>"},
      {"<a:name> , <b:name> ,? or <c:name>", "<a> or <b> or <c>"},
      {"<a:name> , <b:name> and <c>", "<a> and <b> and <c>"},
      {"<a:name> , <b:name> or <c>", "<a> or <b> or <c>"},
      // "Which of my ingredients has moved: the oil, the milk or the jam?"
      {"which|what of the|my|our|these|those <n:noun> has|have|was|were|did <v> , <a> or <b:name> $",
       "which <a> or <b> was <v>"}};
  return all;
}

const std::vector<Pattern>& contraries() {
  static const std::vector<Pattern> all = {
      {"^ has|have|was|were <x:name> ever? been? anywhere|somewhere but|other|else|except than? on|in|at? "
       "<p:name> $",
       "did <x> stay on <p>"},
      {"^ has|have|was|were <x:name> ever? been? anywhere|somewhere but|other|else|except than? on|in|at? "
       "<p:name> <t> $",
       "did <x> stay on <p> <t>"},
  };
  return all;
}

const std::vector<Pattern>& constructions() {
  static const std::vector<Pattern> all = {
      // Around the question.
      {"^ if <c:courtesy> $", ""},
      {"^ if i remember|recall correctly|rightly|right ,?", ""},
      {"^ unless i am mistaken|wrong ,?", ""},
      {"^ not that <x> , but", ""},
      {"^ <m:matrix> as? to|of|about|on? which <x>", "which <x>"},
      {"^ <m:matrix> as? to|of|about|on? what <x>", "what <x>"},
      {"^ <m:matrix> as? to|of|about|on? where <x>", "where <x>"},
      {"^ <m:matrix> as? to|of|about|on? how <x>", "how <x>"},
      {"^ <m:matrix> as? to|of|about|on? whether <x>", "whether <x>"},
      {"^ describe|list|name|tell|say|show|report me|us? what|which <x>", "what <x>"},
      {"the? last time i|we|you|anyone looked|checked $", ""},
      {"when you last looked|checked $", ""},
      {"^ where is the|my? <x> , the|my <n:name> $", "where is the <n>"},
      {"^ how much <n:noun> are <x>", "how many <n> are <x>"},
      {"^ how much <n:plural> is <x>", "how many <n> are <x>"},
      // Who does it, and how often.
      {"keep|keeps|kept|keep|been <v:doing>", "<v>"},
      {"in front of me|us|you", ""},
      {"the|my|our|your|these|those two|three|four|five <n:name>", "the <n>"},
      // What restricts the objects.
      {"how many of the|my|our|these|those <x> is|are <c:colour> $", "how many <c> <x>"},
      {"which|what of the|my|our|these|those <x> is|are <c:colour> $", "which <c> <x>"},
      {"what is the|that|this <c:colour> thing|one on|in|at|inside <x:name> $", "which <c> thing is on <x>"},
      {"^ is? it? true? that? the|my|our? <p:name> has|holds <x> on|in|inside it $",
       "is there <x> on the <p>"},
      {"^ <a:name> or <b:name> bigger|larger $", "which is bigger <a> or <b>"},
      {"^ <a:name> or <b:name> smaller $", "which is smaller <a> or <b>"},
      {"^ <a:name> or <b:name> taller|higher $", "which is taller <a> or <b>"},
      {"^ is more big|large <a> or <b> $", "which is bigger <a> or <b>"},
      {"^ is bigger|larger <a> or <b> $", "which is bigger <a> or <b>"},
      {"^ what is|was the|that|this <c:colour> <n:noun> $", "which <c> <n> are there"},
      {"^ is|are|was|were <x:name> a|an? <c:colour> one|ones|thing|things|object|objects $", "is <x> <c>"},
      {"^ is|are|was|were <x:name> one|some of the <c:colour> ones|things|objects $", "is <x> <c>"},
      {"are there any? <n:noun> that? you|we have never <v> $", "which <n> were never <v>"},
      {"is|are there more <a:noun> than <b:noun> $", "does the <a> outnumber the <b>"},
      {"is|are there fewer|less <a:noun> than <b:noun> $", "does the <b> outnumber the <a>"},
      // Not moved since.
      {"^ is|are <p:name> still? where it|they was|were at|in? <t> $", "was <p> never moved since <t>"},
      {"^ is|are <p:name> still? where i|we|someone left|put it|them $", "was <p> never moved"},
      {"^ is|are <p:name> still where it|they was|were $", "was <p> never moved"},
      {"^ is? there? anything|something unusual|odd|strange $", "is anything out of place"},
      {"^ is|are it|they still? where i|we|someone left|put it|them $", "was it never moved"},
      // When it ends.
      {"how long <x> before|until|till someone|somebody|anyone|anybody <v> it|them|that away|up|again|shut? "
       "$",
       "how long <x>"},
      {"how long did|has|was|had <x:name> stand|stood|sit|lie|stay|stayed|remain|been|standing|lying|sitting "
       "around|about|out|there? $",
       "how long was <x> there"},
      {"for breakfast $", "at breakfast"},
      {"for lunch $", "at lunch"},
      {"for dinner|supper $", "at dinner"},
  };
  return all;
}

}  // namespace loci::memory
