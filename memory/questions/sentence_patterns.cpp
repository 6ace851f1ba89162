#include "memory/questions/sentence.h"

namespace loci::memory {

// {T} at the end of a command is the time since when something holds, in place of what Period says.
// Narrow forms stand before wide ones: the first that fits is taken.
const std::vector<SentencePattern>& sentence_patterns() {
  static const std::vector<SentencePattern> patterns = {
      // What is usual.
      {"what do (we|you|i|they|people) [usually|normally|always] (keep|store|put) (in|on|inside) <P>",
       "kept {P}", Period::none, "What do we keep in this drawer?"},
      {"what (belongs|goes) (in|on|into|onto|inside) <P>", "kept {P}"},
      {"what is (usually|normally|mostly) [kept|stored|standing|lying|found] (in|on|inside) <P>", "kept {P}"},
      {"what is kept (in|on|inside) <P>", "kept {P}"},
      {"where (do|does|should) (we|you|i|they|one) [usually|normally|always|mostly] (keep|store|put) <X>",
       "usual {X}", Period::during, "Where do we keep the cereal?"},
      {"where (do|can|does) (we|you|i|they|one) (usually|normally|always|mostly|typically) "
       "(find|see|have|leave) "
       "<X>",
       "usual {X}", Period::during},
      {"where (does|do|should|must) <X> (belong|go|live|stand|lie|be|usually stand|usually lie|usually go)",
       "usual {X}", Period::during},
      {"where (is|are) <X> (usually|normally|mostly|typically) [kept|stored|standing|lying|found]",
       "usual {X}", Period::during, "Where is the red cup usually in the morning?"},
      {"where is <X> (kept|stored)", "usual {X}", Period::during},
      {"where (is|are) (usually|normally|mostly|typically) <X>", "usual {X}", Period::during},
      {"(which|what|on which|in which) place (is|are) <X> (usually|normally|mostly|typically) [on|in|at]",
       "usual {X}", Period::during},
      {"what is usual place (of|for) <X>", "usual {X}", Period::during},

      // What is with what.
      {"how often (is|are|was|were|have|do you see|did you see) <X> and <Y> [been] [seen] together",
       "together {X} --with {Y}", Period::none, "How often are the red cup and the plate seen together?"},
      {"(is|are|was|were|have) <X> and <Y> [been] [seen|used|often|ever] [seen] together",
       "together {X} --with {Y}"},
      {"(what|which things|which objects) (is|are|was|were) [usually|often|mostly] [seen|used|found] "
       "together with <X>",
       "together {X}", Period::none, "What is used together with the tea cup?"},
      {"(what|which things|which objects|what things) (is|are|was|were) [usually|often|mostly] "
       "(seen|used|found|standing) with <X>",
       "together {X}"},
      {"(what|which things|which objects) (goes|go|belongs|belong) [together] with <X>", "together {X}"},
      {"(what|which objects|which things) else (is|are|lies|stands) [there] (near|close to|next "
       "to|beside|around) <X>",
       "near {X}", Period::at, "What else is there beside the red cup?"},
      {"(what|which objects|which things) (is|are|lies|stands|lie|stand|was|were) (near|close to|next "
       "to|beside|around) <X>",
       "near {X}", Period::at, "What is near the red cup?"},
      {"(what|which objects|which things) (is|are|was|were|stands|stand|lies|lie) within <R> "
       "(of|from|around) <X>",
       "near {X} --radius {R}", Period::at, "What is within 50 cm of the red cup?"},
      {"what is missing (on|in|from|at) <P> for <O>", "missing {P} --for {O}", Period::at,
       "What is missing on the table for breakfast?"},
      {"(what|which objects|which things) (is|are) missing (on|in|from|at) <P>", "missing {P}", Period::at},
      {"is (anything|something) missing (on|in|from|at) <P>", "missing {P}", Period::at},
      {"(what|which things|which objects|which items) (is|are) missing", "missing", Period::at},
      {"is (anything|something) missing", "missing", Period::at},
      {"what kind of (scene|situation|meal|occasion) is (this|that|it)", "kind", Period::at,
       "What kind of scene is this?"},
      {"(what|which) (meal|occasion|situation) (is|was) (this|that|it)", "kind", Period::at},
      {"what is going on [here]", "kind", Period::at},
      {"[what is] (life cycle|lifecycle) of <X>", "lifecycle {X}", Period::none,
       "What is the life cycle of a plate?"},
      {"(where|which way) (does|do) <X> [usually|normally] (travel|wander|move around)", "lifecycle {X}"},
      {"where (should|shall|can|could|must) (i|we|you|one|robot) look (next|first) for <X>", "next-look {X}",
       Period::at, "Where should I look next for the cereal?"},
      {"if <X> is not (on|in|at) <P> where [else] (may|can|could|might|should) (it|they) be", "next-look {X}",
       Period::at, "If the cereal is not on the table, where else may it be?"},
      {"where else (should|shall|can|could|may|might) (<X> be|(i|we|you|one) look for <X>)", "next-look {X}",
       Period::at},
      {"is there (anything|something) [else] (similar to|like) <X>", "like {X}", Period::at},
      {"is there (another|any other) <Y> (similar to|like) <X>", "like {X}", Period::at},
      {"(what|which objects|which things) (resemble|resembles|is similar to|are similar to|looks similar "
       "to|look similar to) <X>",
       "like {X}", Period::at},
      {"(list|show|show me|find) [all|other] (objects|things|items|everything|anything) (similar "
       "to|like|that "
       "look like|that looks like) <X>",
       "like {X}", Period::at},
      {"(what|which objects|which things) (look|looks|is|are) like <X>", "like {X}", Period::at,
       "What looks like the red cup?"},

      // Where has X been, what happened to it.
      {"when did <X> [last] (leave|reach|get to|come to|arrive on|arrive at|arrive in|go to|disappear from) "
       "<P>",
       "changes --object {X} --place {P}", Period::between, "When did the red cup leave the table?"},
      {"(how long|since when|for how long) (is|are|was|were|has|have) <X> [been] [standing|lying] "
       "(on|in|inside|at) <P>",
       "history {X}", Period::between, "How long was the red cup on the table?"},
      {"how (has|have|did) <X> (travelled|traveled|travel|moved|move|wandered|wander) [around|about] "
       "[through "
       "(day|kitchen|flat|house)]",
       "history {X}", Period::between},
      {"where (has|have) <X> been [before|lately|all day]", "history {X}", Period::between,
       "Where has the red cup been?"},
      {"where else (has|have) <X> been", "history {X}", Period::between},
      {"[show [me]|tell me|what is] history of <X>", "history {X}", Period::between},
      {"which places (has|have) <X> (been|stood|lain) (on|in|at)", "history {X}", Period::between},
      {"what (happened|has happened) (to|with) <X>", "changes --object {X}", Period::between,
       "What happened to the cereal?"},
      {"(has|have|was|were) (anyone|someone|anybody|somebody) (moved|taken|used|removed|touched) <X>",
       "changes --object {X}", Period::between},
      {"(did) (anyone|someone|anybody|somebody) (move|take|use|remove|touch) <X>", "changes --object {X}",
       Period::between},
      {"who (moved|took|used|removed|touched) <X>", "changes --object {X}", Period::between},
      {"(has|have|was|were) <X> [been] (moved|taken away|taken|removed|touched)", "changes --object {X}",
       Period::between, "Was the red cup moved this morning?"},
      {"did <X> move", "changes --object {X}", Period::between},
      {"when (was|were) <X> (moved|taken|removed)", "changes --object {X}", Period::between},

      {"what (did|has) <X> (do|done)", "history {X}", Period::between},

      {"[is there|was there|is|was] (anything|something) (new|different) (on|in|at) <P>",
       "changes --place {P}", Period::between, "Is there anything new on the counter?"},
      {"[is there|was there|is|was] (anything|something) (new|different)", "changes", Period::between},
      {"(what|which things|which objects) (disappeared|vanished|went missing|went|left|has gone|have gone|is "
       "gone|are gone|has disappeared|have disappeared) [away] from <P>",
       "changes --kind left --place {P}", Period::between, "What disappeared from the table?"},
      {"(what|which things|which objects) (appeared|has appeared|have appeared|came|arrived|was put|were put|"
       "was added) (on|onto|in|into|at|to) <P>",
       "changes --kind came --place {P}", Period::between, "What appeared on the table?"},
      {"(what|which things|which objects) (moved|has moved|have moved|was moved) (on|in|at) <P>",
       "changes --kind moved --place {P}", Period::between},

      // What the room consists of, and what opens.
      {"what (does|do) [this|our] (room|kitchen|flat|apartment|house) (consist of|contain|have)", "room",
       Period::at, "What does this room consist of?"},
      {"what is this (room|kitchen) (made of|made up of)", "room", Period::at},
      {"(describe|show|show me) [this] (room|kitchen|flat|apartment|house)", "room", Period::at},
      {"(what|which) (furniture|places|surfaces|parts) (is|are|do you know|are there|do we have|does "
       "[this] (room|kitchen) have) [there] [here]",
       "room", Period::at},
      {"what (opens|can be opened|can open|can i open|can one open|moves)", "opens", Period::at,
       "What opens?"},
      {"(what|which) <P> (is open|are open|is closed|are closed|can be opened|can open|open)", "opens {P}",
       Period::at, "Which drawers are open?"},
      {"(is|are) <P> (open|opened|closed|shut|ajar)", "opens {P}", Period::at, "Is the drawer open?"},
      {"when (was|were|did) <P> (last (open|opened|closed|shut)|(open|opened|closed|shut) last)", "opens {P}",
       Period::at, "When was the drawer last opened?"},
      {"when (did|have|has) (you|we|i|anyone|someone|anybody|somebody) last (open|opened|close|closed|shut) "
       "<P>",
       "opens {P}", Period::at},
      {"how (far|wide) (does|do|is|can) <P> (open|opened)", "opens {P}", Period::at},

      // When was it seen.
      {"when (was|is) last time [that] (you|we|i|anyone|someone|anybody|somebody|robot) (saw|have "
       "seen|noticed) <X>",
       "where {X}", Period::at, "When was the last time you saw it?"},
      {"when (did|have|has) (you|we|i|anyone|someone|anybody|somebody|robot) last (see|seen|noticed|notice) "
       "<X>",
       "where {X}", Period::at},
      {"when (was|were) <X> (last seen|seen last|seen|last|ever) (on|in|inside|at) <P>", "was {X} on {P}",
       Period::between},
      {"when (was|were) <X> (last seen|seen last|seen last time)", "where {X}", Period::at},
      {"when (was|were) <X> (on|in|inside|at) <P>", "was {X} on {P}", Period::between,
       "When was the red cup on the table?"},
      {"how long [ago] (is it|was it|did you see|have you not seen) [since you saw] <X>", "where {X}",
       Period::at},

      // Where is X.
      {"where (did|have|had|do) (i|we|you|he|she|they|someone|somebody|anyone) "
       "(leave|left|put|place|placed|lay|lose|lost) "
       "<X>",
       "where {X}", Period::either, "Where did I leave my tea cup?"},
      {"where (did|have|had) (you|we|i|anyone|someone|anybody|somebody) [last] (see|seen|saw|notice|noticed) "
       "<X> last",
       "where {X}", Period::either},
      {"where (did|have|had) (you|we|i|anyone|someone|anybody|somebody) [last] (see|seen|saw|notice|noticed) "
       "<X>",
       "where {X}", Period::either},
      {"where (is|are|has|have|did) <X> (gone|gone to|got to|go|go to|end up|ended up)", "where {X}",
       Period::either},
      {"where (is|are|was|were) <X>", "where {X}", Period::either, "Where is the red cup?"},
      {"where (i|we|you) (left|put|placed|lost|can find|could find) <X>", "where {X}", Period::either},
      {"where <X> (is|are|was|were)", "where {X}", Period::either},
      {"where (can|could|do|should) (i|we|you|one) (find|look for|see|get) <X>", "where {X}", Period::either},
      {"(find|locate|search|search for|look for) <X>", "where {X}", Period::either},
      {"(i|we) (cannot|can not|could not|can't) find <X>", "where {X}", Period::either},
      {"(i|we) [have] (lost|misplaced|miss) <X>", "where {X}", Period::either},
      {"(i am|we are) looking for <X>", "where {X}", Period::either},
      {"(has|have|did) (anyone|someone|anybody|somebody|you) (seen|see) <X> "
       "(anywhere|somewhere|lately|recently|around)",
       "where {X}", Period::either},
      {"(has|have) (anyone|someone|anybody|somebody|you) seen <X>", "where {X}", Period::either},
      {"do you (remember|know) <X>", "where {X}", Period::either},

      // Is there any X on P; what is on P.
      {"(is|are|was|were) there (anything|something|things|any things|any objects|any object|objects|any "
       "items|still "
       "anything|anything left) (on|upon|onto) <P>",
       "on {P}", Period::at, "Is there anything on the couch table?"},
      {"(is|are|was|were) there (anything|something|things|any things|any objects|any object|objects|any "
       "items|still "
       "anything|anything left) (in|inside|within) <P>",
       "in {P}", Period::at},
      {"(is|was) (anything|something) (on|upon) <P>", "on {P}", Period::at},
      {"(is|was) (anything|something) (in|inside) <P>", "in {P}", Period::at},
      {"(is|was) <P> (empty|free|clear|full|occupied|in use|tidy)", "on {P}", Period::at,
       "Is the table free?"},
      {"(is|are) there <X> (on|upon) <P>", "on {P} --object {X}", Period::at,
       "Is there any cereal on the kitchen table?"},
      {"(is|are) there <X> (in|inside) <P>", "in {P} --object {X}", Period::at},
      {"how many (things|objects|items) (are|are there|were|do we have|have we) (on|upon) <P>", "on {P}",
       Period::at},
      {"how many (things|objects|items) (are|are there|were|do we have|have we) (in|inside) <P>", "in {P}",
       Period::at},
      {"how many <X> (are|are there|were|do we have|have we) (on|upon) <P>", "on {P} --object {X}",
       Period::at},
      {"how many <X> (are|are there|were|do we have|have we) (in|inside) <P>", "in {P} --object {X}",
       Period::at},
      {"how many <X> (are there|do we have|have we|do you know|have you seen)", "objects {X}", Period::at,
       "How many red things are there?"},
      {"(do|did) (we|i|you|they) have <X> (on|upon) <P>", "on {P} --object {X}", Period::at},
      {"(do|did) (we|i|you|they) have <X> (in|inside) <P>", "in {P} --object {X}", Period::at,
       "Do we have milk in the fridge?"},
      {"(have|had) (we|i|you|they) [got] <X> (in|inside) <P>", "in {P} --object {X}", Period::at},
      {"(have|had) (we|i|you|they) [got] <X> (on|upon) <P>", "on {P} --object {X}", Period::at},
      {"is <X> [still|now|already] (on|upon) <P>", "on {P} --object {X}", Period::at,
       "Is the milk still on the table?"},
      {"is <X> [still|now|already] (in|inside) <P>", "in {P} --object {X}", Period::at},
      {"are <X> [still|now|already] (on|upon) <P>", "on {P} --object {X}", Period::at},
      {"are <X> [still|now|already] (in|inside) <P>", "in {P} --object {X}", Period::at},
      {"(was|were) <X> [ever|still] there [at all|ever]", "was {X} on there", Period::between,
       "Was it there at all between nine and ten?"},
      {"(was|were) <X> ever (on|in|inside|at) <P>", "was {X} on {P}", Period::between},
      {"(was|were) there <X> (on|in|inside|at) <P>", "was {X} on {P}", Period::between},
      {"(was|were) <X> (on|in|inside|at) <P>", "was {X} on {P}", Period::between,
       "Was the red cup on the table between nine and ten?"},
      {"(has|have) <X> [ever] (been|stood|lain) (on|in|inside|at) <P>", "was {X} on {P}", Period::between},
      {"did <X> (stand|lie) (on|in|inside|at) <P>", "was {X} on {P}", Period::between},
      {"(did|have|has) (you|we|anyone|anybody|someone|robot) [ever] (see|seen) <X> (on|in|inside|at) <P>",
       "was {X} on {P}", Period::between},
      {"(did|have) you (see|seen) <X>", "where {X}", Period::either, "Have you seen my tea cup?"},
      {"what (disappeared|vanished) (on|in|at|inside) <P>", "changes --kind left --place {P}",
       Period::between},
      {"what (changed|has changed|happened|has happened) "
       "(on|in|at|inside) <P>",
       "changes --place {P}", Period::between, "What changed on the table since nine?"},
      {"what (was|has been) (taken|removed|taken away) from <P>", "changes --kind left --place {P}",
       Period::between},
      {"(was|were|has|has been|did anyone|did someone|has anyone|has someone) <P> "
       "(opened|open|closed|close|shut)",
       "changes --place {P}", Period::between, "Was the drawer opened this morning?"},
      {"(did|has) (anyone|someone|anybody|somebody) (open|opened|close|closed|shut) <P>",
       "changes --place {P}", Period::between},
      {"when was <P> (opened|closed|shut)", "changes --place {P}", Period::between},
      {"what (is|are|was|were|lies|stands|sits|stand|lie) [there|lying|standing|placed] (on|upon|on top of) "
       "<P>",
       "on {P}", Period::at, "What is on the table?"},
      {"what (is|are|was|were|lies|stands|stand|lie) [there|lying|standing|placed] (in|inside|within) <P>",
       "in {P}", Period::at},
      {"(what|which) (objects|object|things|thing|items|item) (is|are|was|were|stand|lie|do we have|are "
       "there) "
       "[standing|lying|placed] (on|upon) <P>",
       "on {P}", Period::at, "What objects are standing on the counter?"},
      {"(what|which) (objects|object|things|thing|items|item) (is|are|was|were|stand|lie|do we have|are "
       "there) "
       "[standing|lying|placed] (in|inside) <P>",
       "in {P}", Period::at},
      {"(what|which) <X> (is|are|was|were|stand|stands|lie|lies) [standing|lying|placed] (on|upon) <P>",
       "on {P} --object {X}", Period::at},
      {"(what|which) <X> (is|are|was|were|stand|stands|lie|lies) [standing|lying|placed] (in|inside) <P>",
       "in {P} --object {X}", Period::at},
      {"what (do|did) (we|you|i) (have|see|know|find) (on|upon) <P>", "on {P}", Period::at},
      {"what (do|did) (we|you|i) (have|see|know|find) (in|inside) <P>", "in {P}", Period::at},
      {"what did <P> look like", "on {P}", Period::at},
      {"what (does|did) <P> contain", "in {P}", Period::at},
      {"(list|show|show me|tell me|name) [all|everything|what is] [objects|things|items|contents] (on|upon) "
       "<P>",
       "on {P}", Period::at},
      {"(list|show|show me|tell me|name) [all|everything|what is] [objects|things|items|contents] "
       "(in|inside|of) <P>",
       "in {P}", Period::at},

      // What happened.
      {"what (changed|has changed|happened|has happened|is new|is different|moved|has moved|did i miss|did "
       "we miss|has been "
       "moved|was moved)",
       "changes", Period::between, "What changed since this morning?"},
      {"what (appeared|has appeared)", "changes --kind came", Period::between},
      {"what (disappeared|has disappeared|is gone|has gone|went away|was removed|has been removed)",
       "changes --kind left", Period::between},
      {"(did|has) (anything|something) (change|changed|happen|happened|move|moved)", "changes",
       Period::between},
      {"(was|has) (anything|something) [been] (moved|taken|removed|changed)", "changes", Period::between},
      {"(what|which things|which objects) (have|has|did) (you|we|robot|anyone) not (seen|see|noticed)",
       "objects --unseen-since {T}", Period::at, "What have you not seen since nine?"},
      {"(what|which things|which objects) (have|has) not been seen", "objects --unseen-since {T}",
       Period::at},
      {"what (did|have) (you|we|robot) (see|seen|notice|noticed|do|done|experience)", "timeline",
       Period::between, "What did you see between eight and nine?"},
      {"(tell me about|how was) (your|our|my) day", "timeline", Period::between},
      {"[show [me]] timeline", "timeline", Period::between},
      {"(when|where) did you look", "scenes", Period::between, "When did you look?"},

      // What is known.
      {"(what|which|which thing|which object|which one) is (biggest|largest) [thing|object|item|one|of all]",
       "objects biggest", Period::at},
      {"(what|which|which thing|which object|which one) is smallest [thing|object|item|one|of all]",
       "objects smallest", Period::at},
      {"(what|which|which thing|which object|which one) is tallest [thing|object|item|one|of all]",
       "objects tallest", Period::at},
      {"(what|which|which thing|which object|which one) is (biggest|largest) [thing|object|item|one] (on|in) "
       "<P>",
       "objects biggest on {P}", Period::at, "What is the biggest thing on the table?"},
      {"(what|which|which thing|which object|which one) is smallest [thing|object|item|one] (on|in) <P>",
       "objects smallest on {P}", Period::at},
      {"(what|which|which thing|which object|which one) is tallest [thing|object|item|one] (on|in) <P>",
       "objects tallest on {P}", Period::at},
      {"(what|which) (objects|things|items) (do you know|are there|have you seen|do you remember|do we "
       "have|exist)",
       "objects", Period::at, "What objects do you know?"},
      {"what do you (know|remember)", "objects", Period::at},
      {"(list|show me|show|name) [all|everything] [objects|things|items]", "objects", Period::at},
      {"(list|show me|show|name) [all|everything] [that is] <X>", "objects {X}", Period::at,
       "Show me all red things."},
      {"(what|which) (objects|object|things|thing|items|item) (is|are) <X>", "objects {X}", Period::at},
      {"(who owns|who is owner of|whose is|whose are|who has) <X>", "about {X}", Period::at,
       "Who owns the red cup?"},
      {"whose <X> is (this|that|it)", "about {X}", Period::at},
      {"(what|which) (color|colour|shape|size|class|kind|brand) (is|are|has|have|does|do) <X> [have|of]",
       "about {X}", Period::at, "What colour is the cup?"},
      {"how (big|large|small|tall|high|wide|long|heavy) (is|are) <X>", "about {X}", Period::at},
      {"what (does|do) <X> look like", "about {X}", Period::at},
      {"what (is written|does it say|is printed) on <X>", "about {X}", Period::at},
      {"what (do|did) (you|we) know (about|of) <X>", "about {X}", Period::at},
      {"(describe|tell me [everything|all|more] about|what about) <X>", "about {X}", Period::at,
       "What do you know about the red cup?"},
      {"(do|did) (we|i|you) have <X>", "where {X}", Period::either, "Do we have milk?"},
      {"(have|had) (we|i|you) got <X>", "where {X}", Period::either},
      {"(is|are) there <X> [left]", "where {X}", Period::either},

      // Tasks.
      {"(set|lay|prepare) <P> for <O>", "task set {P} --for {O}", Period::none,
       "Set the table for breakfast."},
      {"(prepare|make|lay [table] for|set [table] for) (breakfast|lunch|dinner|supper|tea)",
       "task set table"},
      {"(lay|set) <P>", "task set {P}"},
      {"(clean|tidy|clear|straighten) [up] (kitchen|room|flat|house|apartment|everything|here|whole kitchen)",
       "task clean", Period::none, "Clean up the kitchen."},
      {"(clean|tidy|clear) (kitchen|room|flat|house|apartment|everything) up", "task clean"},
      {"(clean|tidy|clear) up", "task clean"},
      {"(clean|tidy|clear|wipe) [up|off] <P>", "task clean {P}", Period::none, "Clear the table."},
      {"(clean|tidy|clear) <P> (up|off)", "task clean {P}"},
      {"(stow|put|tidy|store|pack|clear) away <X> (into|onto|to) <P>", "task stow {X} --to {P}"},
      {"(stow|put|tidy|store|pack|clear) away <X>", "task stow {X}", Period::none,
       "Stow away the items in the shopping basket."},
      {"(stow|put|tidy|store|pack|clear) <X> away", "task stow {X}"},
      {"(put|return) <X> back", "task stow {X}"},
      {"(put|place|stow|store|move|lay|set|take) <X> (in|into|inside|on|onto|to) <P>",
       "task stow {X} --to {P}", Period::none, "Put all perishable items in the fridge."},
      {"(bring|carry) <X> to (me|us)", "task bring {X}"},
      {"(bring|carry) <X> (to|into|onto) <P>", "task stow {X} --to {P}"},
      {"(bring|fetch|get|give|hand|pass) (me|us) <X>", "task bring {X}", Period::none,
       "Bring me my tea cup."},
      {"(bring|fetch|get) <X>", "task bring {X}"},
      {"(i|we) (want|need|would like|would like to have|want to have) <X>", "task bring {X}"},
  };
  return patterns;
}

}  // namespace loci::memory
