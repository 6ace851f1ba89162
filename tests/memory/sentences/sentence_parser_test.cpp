#include "memory/sentences/sentence_parser.h"

#include <gmock/gmock.h>

namespace loci::memory {
namespace {

/// The last scene is on a Friday at 10:30.
const TimeReader kTimes(parse_time("2026-05-01T10:30:00Z"), TimeZone());

struct Case {
  const char* sentence;
  const char* command;
};

void expect_commands(const std::vector<Case>& cases) {
  for (const Case& one : cases) {
    const auto query = parse_sentence(one.sentence, kTimes);
    ASSERT_TRUE(query) << one.sentence;
    EXPECT_EQ(query->text(), one.command) << one.sentence;
  }
}

TEST(Sentences, TheTwelveOfTheIntroductionAreUnderstood) {
  expect_commands({
      {"Bring me my tea cup.", "task bring 'tea cup'"},
      {"Put all perishable items in the fridge.", "task stow 'perishable items' --destination fridge"},
      {"Stow away the items in the shopping basket.", "task stow 'items in shopping basket'"},
      {"Set the table for breakfast.", "task set table --occasion breakfast"},
      {"Clean up the kitchen.", "task clean"},
      {"Is there anything on the couch table?", "on 'couch table'"},
      {"Where did I leave my tea cup?", "where 'tea cup'"},
      {"When was the last time you saw it?", "where it"},
      {"Is there any cereal on the kitchen table?", "on 'kitchen table' --object cereal"},
      {"What objects are standing on the counter?", "on counter"},
      {"What do we keep in this drawer?", "contents-history 'this drawer'"},
      {"Do we have milk in the fridge?", "in fridge --object milk"},
  });
}

TEST(Sentences, WrappersAsNothing) {
  expect_commands({
      {"Would you happen to know where I put the jam?", "where jam"},
      {"I was wondering whether the milk is on the table", "on table --object milk"},
      {"One more thing: where is the tea?", "where tea"},
      {"Where is the tea, would you happen to know?", "where tea"},
      {"Sorry to bother you again, but is the shelf empty?", "on shelf"},
      {"Any idea where the cereal has got to?", "where cereal"},
      {"The milk is on the table, isn't it?", "on table --object milk"},
      {"Isn't the milk on the table?", "on table --object milk"},
      {"What makes you think the milk is on the table?", "on table --object milk"},
      {"The second drawer, when was it opened?", "changes --kind opened --place 'drawer 2'"},
      {"The milk: is it on the table?", "on table --object milk"},
  });
}

TEST(Sentences, WhatWasOpenedOrClosedNeedsNoNameOfAPart) {
  expect_commands({
      {"What was opened today?", "changes --between today today --kind opened"},
      {"Was anything opened today?", "changes --between today today --kind opened"},
      {"What did I open this morning?", "changes --between 'this morning' 'this morning' --kind opened"},
      {"What was closed last?", "changes --kind closed"},
      {"What was opened first?", "changes --kind opened"},
      {"Which drawer was opened first?", "changes --kind opened --place drawer"},
      {"What can be opened?", "opens"},
      {"Is anything open?", "opens"},
  });
}

TEST(Sentences, AComparativeBeforeANameChoosesOne) {
  expect_commands({
      {"Where is the bigger cup?", "where 'bigger cup'"},
      {"Is the smaller cup on the counter?", "on counter --object 'smaller cup'"},
      {"What is the second biggest object?", "objects 'second biggest object'"},
      {"Which object is thinnest?", "objects thinnest"},
      {"Which box is the shortest?", "objects 'shortest box'"},
  });
}

TEST(Sentences, RelationsOfTwoAndToAnything) {
  expect_commands({
      {"What is between the cup and the box?", "near cup --relation between --with box"},
      {"Is the pot between the cup and the box?", "near cup --object pot --relation between --with box"},
      {"Is the cup behind something?", "near cup --relation in-front"},
      {"Is the box in front of anything?", "near box --relation behind"},
      {"Which box is nearer to the pot?", "near pot --count 1 --object box --radius '10 m'"},
      {"Which object is farthest from the pot?", "near pot --order farthest --radius '10 m'"},
  });
}

TEST(Sentences, AColourIsAPropertyAndAnOrangeIsAFruit) {
  expect_commands({
      {"Is the pot grey?", "about pot --property colour --value grey"},
      {"Are all cups red?", "about cups --property colour --value red"},
      {"Do the boxes have different colours?", "about boxes --property colour --value different"},
      {"What is green?", "objects green"},
      {"Do we have an orange?", "where oranges"},
      {"Is there anything orange?", "where orange"},
      {"Where is the orange box?", "where 'orange box'"},
  });
}

TEST(Sentences, AColourAfterAKindChoosesOfIt) {
  expect_commands({
      {"Which cup is red?", "objects 'red cup'"},
      {"How many cups are red?", "objects 'red cups'"},
      {"Which box on the counter is red?", "on counter --object 'red box'"},
      {"How many boxes on the counter are red?", "on counter --object 'red boxes'"},
      {"What on the table is green?", "on table --object green"},
      {"What colour is the biggest box?", "about 'biggest box' --property colour"},
  });
}

TEST(Sentences, NeighboursAreAskedForOnOnePlace) {
  expect_commands({
      {"Which thing on the table is nearest to the plate?",
       "near plate --count 1 --place table --radius '10 m'"},
      {"Which cup on the table is behind the plate?",
       "near plate --object cup --place table --relation behind"},
  });
}

TEST(Sentences, WhereSomethingHasBeenIsNoQuestionWhetherItExists) {
  expect_commands({
      {"How long has the milk been there?", "history milk --place there"},
      {"Since when has it been there?", "history it --place there"},
      {"Has the milk ever been there?", "was milk on there"},
  });
}

TEST(Sentences, PeopleWereInView) {
  expect_commands({
      {"Was anybody in the kitchen between nine and ten?", "people --between nine ten"},
      {"Did you see anybody today?", "people --between today today"},
      {"Was anybody at the counter?", "changes --place counter"},
  });
}

TEST(Sentences, ACanIsANounAfterAVerb) {
  expect_commands({
      {"Where could the grey can be?", "where 'grey can'"},
      {"Where can the grey can be?", "where 'grey can'"},
      {"Where might the can be?", "where can"},
  });
}

TEST(Sentences, TelegraphicOnesAreUnderstood) {
  expect_commands({
      {"where banana", "where banana"},
      {"Last known location of the plate", "where plate"},
      {"Time of the last observation of the oil?", "where oil"},
      {"Number of mugs on counter_1 at 14:00?", "on counter_1 --at 14:00 --object mugs"},
      {"Count the mugs on the table", "on table --object mugs"},
      {"State of drawer_1?", "opens drawer_1"},
      {"Anything yellow on the counter?", "on counter --object yellow"},
      {"contents of drawer 1", "in 'drawer 1'"},
  });
}

TEST(Sentences, WhatRestrictsIsNeverPassedOver) {
  for (const char* sentence :
       {"Where is the milk not?", "What is not on the table anymore?",
        "Where was the jam when the drawer was opened?", "Where will the milk be?",
        "Where is the nearest shop?", "How much milk is on the table?",
        "Where is the cup that was on the table?", "Where is the cup except for the milk?",
        "Is the milk almost on the table?", "Can you open the drawer?"})
    EXPECT_FALSE(parse_sentence(sentence, kTimes)) << sentence;
}

TEST(Sentences, QuantifiersAndComparisonsAreTakenIntoAccount) {
  expect_commands({
      {"Are there two cups on the counter?", "on counter --count two --object cups"},
      {"Which object is closest to the pot?", "near pot --count 1 --radius '10 m'"},
      {"Where did the cup come from?", "history cup --before here"},
      {"Where was the cup before it came to the table?", "history cup --before table"},
      {"Did the cup go from the table to the drawer?",
       "changes --kind came --object cup --other table --place drawer"},
      {"Which drawer was never opened?", "opens drawer --state unopened"},
      {"What is on the table except for the milk?", "on table --except milk"},
      {"Which items never left the counter today?",
       "contents-history counter --between today today --state stayed"},
      {"What is missing from the table compared with this morning?",
       "contents-history table --from 'this morning' --state gone"},
  });
  const auto asks = [](const char* sentence) { return parse_sentence(sentence, kTimes)->asks; };
  EXPECT_EQ(asks("Are both cups on the counter?"), Asks::all);
  EXPECT_EQ(asks("Is only the milk on the table?"), Asks::only);
  EXPECT_EQ(asks("Was the milk always on the table?"), Asks::throughout);
  EXPECT_EQ(asks("Was the milk on the table all day?"), Asks::throughout);
  EXPECT_EQ(asks("Are the cups in the same place?"), Asks::together);
  EXPECT_EQ(asks("Until what time was the milk on the table?"), Asks::until);
  EXPECT_EQ(asks("Which object was moved most often?"), Asks::most);
}

TEST(Sentences, WhatSpansATimeAsksForAllOfIt) {
  const auto expect_asks = [](Asks asks, const std::vector<const char*>& sentences) {
    for (const char* sentence : sentences) {
      const auto query = parse_sentence(sentence, kTimes);
      ASSERT_TRUE(query) << sentence;
      EXPECT_EQ(query->question, "was") << sentence;
      EXPECT_EQ(query->asks, asks) << sentence;
    }
  };
  expect_asks(
      Asks::throughout,
      {"Has the cup been in the drawer since this morning?", "Was the box on the counter from 8 to 12?",
       "Was the cup kept in the drawer from nine till noon?", "Has the milk been on the table for two hours?",
       "Has the milk been on the table for more than an hour?",
       "Was the box on the counter the whole time between 8 and 12?",
       "Did the milk remain on the table all day?"});
  expect_asks(Asks::lasted,
              {"Did the milk stay on the counter?", "Was the bowl on the table until 6 pm?",
               "Has the bowl remained on the table?", "Did the bowl stay on the table till noon?"});
  expect_asks(
      Asks::verdict,
      {"Was the cup on the table between nine and ten?", "Has the cup ever been in the drawer since noon?",
       "Was the cup at any time in the drawer since noon?", "Has the cup been on the table in the last hour?",
       "Was the cup on the table before noon?"});
  EXPECT_EQ(parse_sentence("Has the cup been moved since noon?", kTimes)->asks, Asks::verdict);
  EXPECT_FALSE(parse_sentence("Has the cup been in the same place since noon?", kTimes));
}

TEST(Sentences, WhatWasNotThereIsWhatWasElsewhere) {
  expect_commands({
      {"Which objects were never on the table?", "objects --not-at table --to now"},
      {"What has never been in the drawer?", "objects --not-at drawer --to now"},
      {"What wasn't on the table at 8?", "objects --at 8 --not-at table"},
      {"What is not on the table?", "objects --not-at table"},
      {"Which cups are not on the counter?", "objects cups --not-at counter"},
      {"What never left the table?", "contents-history table --state stayed"},
      {"What did not stay on the table?", "contents-history table --state gone"},
      {"Where is the cup that is not on the table?", "objects cup --not-at table"},
  });
}

TEST(Sentences, ThePastIsNotAnsweredByThePresent) {
  expect_commands({
      {"Which cup was on the table?", "contents-history table --object cup"},
      {"Which boxes were on the table?", "contents-history table --object boxes"},
      {"How many cups were on the table?", "contents-history table --object cups"},
      {"What was the biggest object on the table today?",
       "contents-history table --between today today --object 'biggest object'"},
      {"What was the biggest object on the table at 8?", "objects 'biggest object on table' --at 8"},
      {"What was next to the plate?", "near plate --at then --relation next-to"},
      {"What was near the plate?", "near plate --at then"},
      {"What was gone at 4 pm?", "objects --at '4 pm' --state gone"},
      {"How many objects were gone at 4 pm?", "objects --at '4 pm' --state gone"},
      {"Was the plate gone at 4 pm?", "where plate --at '4 pm'"},
      {"When was the last time something was on the shelf?", "contents-history shelf"},
  });
}

TEST(Sentences, EventsAndStaysAreCompared) {
  expect_commands({
      {"Was drawer 2 opened before drawer 1?", "compare 'drawer 2' --by opened-before --with 'drawer 1'"},
      {"Did the cup come to the table before the bowl?",
       "compare cup --by came-before --place table --with bowl"},
      {"Was the plate on the table before the bowl?",
       "compare plate --by came-before --place table --with bowl"},
      {"Was the plate on the table longer than the bowl?",
       "compare plate --by longer --place table --with bowl"},
      {"Which left the table first, the plate or the bowl?",
       "changes --kind left --object 'plate or bowl' --place table"},
      {"Were the cup and the bowl ever on the table together?", "was 'cup and bowl' on table"},
      {"Were the cup and the bowl on the table at the same time?", "was 'cup and bowl' on table"},
  });
  EXPECT_EQ(parse_sentence("Were the cups ever on the counter together?", kTimes)->asks, Asks::together);
}

TEST(Sentences, WhatSurroundsAQuestionIsNoPartOfIt) {
  expect_commands({
      {"We have guests tonight, what is standing on the table?", "on table"},
      {"I was out all morning, so where is the jam?", "where jam"},
      {"I fancy a hot drink. Is the tea on the counter?", "on counter --object tea"},
      {"um hey robot where's uh where's the tea", "where tea"},
      {"Do we still have tomatoes or do I need to buy some?", "where tomatoes"},
      {"Is the banana on the table, dear?", "on table --object banana"},
  });
}

TEST(Sentences, OneOfAllThatChangedIsAskedForByWhichAndWhat) {
  expect_commands({
      {"Which cup was moved last?", "changes --kind relocated --object cup"},
      {"What was moved first on the table?", "changes --kind relocated --place table"},
      {"Which thing was put on the table last?", "changes --kind came --place table"},
      {"What was added today?", "changes --between today today --kind came"},
      {"How many cups were moved?", "changes --kind relocated --object cups"},
      {"When was something last moved?", "changes --kind relocated"},
      {"How long ago was the pot moved?", "changes --kind relocated --object pot"},
  });
  EXPECT_EQ(parse_sentence("Which cup was moved last?", kTimes)->asks, Asks::latest);
  EXPECT_EQ(parse_sentence("Which left first, the plate or the bowl?", kTimes)->asks, Asks::earliest);
  EXPECT_EQ(parse_sentence("How long ago was the pot moved?", kTimes)->asks, Asks::ago);
}

TEST(Sentences, HowOftenAndHowLongAreTakenIntoAccount) {
  expect_commands({
      {"What was moved more than once?", "changes --kind relocated --times 2"},
      {"Was the cup moved at least three times today?",
       "changes --between today today --kind handled --object cup --times 3"},
      {"Which drawers were opened several times?", "changes --kind opened --place drawers --times 2"},
      {"Where was everything at nine?", "objects --at nine"},
      {"Which place has the most objects?", "room"},
      {"What is the most crowded drawer?", "room drawer"},
      {"Which object has been on the table the longest?", "contents-history table"},
      {"How long has the drawer been empty?", "contents-history drawer"},
      {"How often did you look at the shelf today?", "contents-history shelf --between today today"},
      {"How long has the drawer been closed?", "changes --kind joint_changed --place drawer"},
  });
  const auto asks = [](const char* sentence) { return parse_sentence(sentence, kTimes)->asks; };
  EXPECT_EQ(asks("Which object has been on the table the longest?"), Asks::longest);
  EXPECT_EQ(asks("What is the longest object on the table?"), Asks::objects);
  EXPECT_EQ(asks("Which place has the most objects?"), Asks::most);
  EXPECT_EQ(asks("How often did you look at the shelf?"), Asks::looks);
  EXPECT_FALSE(parse_sentence("Where was the cup more than once?", kTimes)) << "no answer counts that";
}

TEST(Sentences, PlacesAreAskedForAndWhetherTheyAreEmpty) {
  expect_commands({
      {"Which drawers are empty?", "room drawers --state empty"},
      {"Is any drawer empty?", "room drawer --state empty"},
      {"Which drawers have something in them?", "room drawers --state 'in use'"},
      {"Where on the table is the milk?", "where 'milk on table'"},
      {"What is out of its usual place?", "digest"},
      {"Is anything out of place?", "digest"},
      {"Is everything in its usual place?", "digest"},
  });
}

TEST(Sentences, TwoObjectsAreAtOnePlaceNowOrWereSeenTogether) {
  expect_commands({
      {"Are the oil and the tea in the same place?", "where 'oil and tea'"},
      {"Were the oil and the tea ever seen together?", "co-occurrence oil --with tea"},
      {"Did the apple disappear earlier than the plate?", "compare apple --by left-before --with plate"},
      {"Did the plate leave the table before the bowl?",
       "compare plate --by left-before --place table --with bowl"},
  });
}

TEST(Sentences, WhatAPersonDidIsNoPartOfATime) {
  expect_commands({
      {"What changed after my wife came home at five?", "changes --from five"},
      {"Where was the cup when I came home at six?", "where cup --at six"},
      {"Did anything move while I was vacuuming between nine and ten?", "changes --between nine ten"},
  });
}

TEST(Sentences, SeveralTyposAreReadOver) {
  expect_commands({
      {"whre is teh milk", "where milk"},
      {"how mnay things were on the tabel at 8:20", "on table --at 8:20"},
      {"since whne is teh apple missing", "changes --kind left --object apple"},
  });
}

TEST(Sentences, UsualPlacesByHourAndWeekday) {
  expect_commands({
      {"Where is the tea cup normally on Mondays?", "usual 'tea cup' --during monday"},
      {"Which place is the tea cup usually at around noon?", "usual 'tea cup' --during noon"},
      {"Where do I usually find the tea cup in the morning?", "usual 'tea cup' --during 'the morning'"},
      {"Where is the pot usually between nine and ten?", "usual pot --during 'nine to ten'"},
      {"Where does the tea cup belong?", "usual 'tea cup'"},
  });
}

TEST(Sentences, FurtherWaysToAsk) {
  expect_commands({
      {"Where's my tea cup gone?", "where 'tea cup'"},
      {"Have you seen the tea cup anywhere?", "where 'tea cup'"},
      {"When did the tea cup last leave the table?", "changes --kind left --object 'tea cup' --place table"},
      {"How has the tea cup travelled through the day?", "history 'tea cup' --between today today"},
      {"What goes together with the tea cup?", "co-occurrence 'tea cup'"},
      {"Which things are often seen with the tea cup?", "co-occurrence 'tea cup'"},
      {"What meal is this?", "scene-type"},
      {"Where else could the jam be?", "search-next jam"},
      {"Is there another cup like this one?", "like 'this one'"},
      {"Show me things similar to object_4.", "like object_4"},
      {"How many things are on the table right now?", "on table --at now"},
      {"What did the table look like at nine?", "on table --at nine"},
      {"Anything new on the counter since 12:00?", "changes --from 12:00 --place counter"},
      {"What disappeared from the table this morning?",
       "changes --between 'this morning' 'this morning' --kind left --place table"},
      {"What appeared on the table?", "changes --kind came --place table"},
      {"What disappeared?", "objects --state gone"},
      {"What have you not seen since nine?", "objects --unseen-since nine"},
      {"What have you seen since nine?", "objects --from nine"},
      {"What is the smallest thing?", "objects 'smallest thing'"},
      {"What is the biggest thing on the table?", "objects 'biggest thing on table'"},
      {"Which is the smallest on the shelf?", "objects 'smallest on shelf'"},
      {"What else is there beside object_1?", "near object_1 --relation next-to"},
      {"What is on the table to the left of the pot?", "near pot --place table --relation left"},
      {"If it is not on the table, where else may it be?", "search-next it"},
      {"When was the jam on the table?", "was jam on table"},
      {"Was the tea cup ever on the shelf?", "was 'tea cup' on shelf"},
      {"How long was the tea cup on the table?", "history 'tea cup' --place table"},
      {"Since when is the tea cup in the drawer?", "history 'tea cup' --place drawer"},
      {"What stands within 50 cm of object_4?", "near object_4 --radius '50 cm'"},
  });
}

TEST(Sentences, QuestionsAboutOneObject) {
  expect_commands({
      {"where is the red cup", "where 'red cup'"},
      {"Where's my red cup now?", "where 'red cup' --at now"},
      {"Where are my keys?", "where keys"},
      {"Do you know where the milk is?", "where milk"},
      {"Can you tell me where I can find the milk?", "where milk"},
      {"Where can I find a large bowl?", "where 'large bowl'"},
      {"I can't find object_3", "where object_3"},
      {"I am looking for the tea", "where tea"},
      {"Have you seen my tea cup?", "where 'tea cup'"},
      {"Has anyone seen the jam?", "where jam"},
      {"Find the jam!", "where jam"},
      {"When did you last see the bowl?", "where bowl"},
      {"When was the plate last seen?", "where plate"},
      {"Where has the red cup been?", "history 'red cup'"},
      {"Where has the red cup been since nine?", "history 'red cup' --from nine"},
      {"What happened to the cereal?", "changes --object cereal"},
      {"Who moved my tea cup?", "changes --kind handled --object 'tea cup'"},
      {"Has the pot been moved?", "changes --kind handled --object pot"},
      {"Where do we keep the cereal?", "usual cereal"},
      {"Where does the pot belong?", "usual pot"},
      {"Where is the pot usually?", "usual pot"},
      {"Do we have milk?", "where milk"},
      {"Where have you seen the red cup last?", "where 'red cup'"},
      {"What did the cup do today?", "history cup --between today today"},
      {"Was it there at all between nine and ten?", "was it on there --between nine ten"},
      {"Who owns the red cup?", "about 'red cup' --property owner"},
      {"What colour is object_3?", "about object_3 --property colour"},
      {"Do all the cups have the same colour?", "about cups --property colour"},
      {"Are the cups of the same size?", "about cups --property size"},
      {"What is near the can?", "near can"},
      {"Is the milk taller than the can?", "compare milk --by taller --with can"},
      {"How big is the bowl?", "about bowl --property size"},
      {"Which things are blue?", "objects blue"},
      {"Show me everything green", "objects green"},
      {"What is within 50 cm of the cup?", "near cup --radius '50 cm'"},
      {"What is to the left of the cup?", "near cup --relation left"},
      {"Is the tea on the right side of the cup?", "near cup --object tea --relation right"},
      {"Is there anything in front of the cup?", "near cup --relation in-front"},
      {"What's hidden behind the cup?", "near cup --relation behind"},
      {"Which bottle is under the shelf?", "near shelf --object bottle --relation under"},
  });
}

TEST(Sentences, QuestionsAboutTheRoom) {
  expect_commands({
      {"What does this room consist of?", "room"},
      {"What opens?", "opens"},
      {"Is the fridge open?", "opens fridge"},
      {"Was the fridge opened today?", "changes --between today today --kind opened --place fridge"},
      {"When was drawer_1 last opened?", "changes --kind opened --place drawer_1"},
      {"Which drawers are open?", "opens drawers --state open"},
      {"Which things are missing?", "missing"},
  });
}

TEST(Sentences, QuestionsAboutPlaces) {
  expect_commands({
      {"What is on the table?", "on table"},
      {"What's in drawer 1?", "in 'drawer 1'"},
      {"Which things are in the drawer?", "in drawer"},
      {"What does the drawer contain?", "in drawer"},
      {"Is anything in drawer_2?", "in drawer_2"},
      {"Is the table free?", "on table"},
      {"How many things are on the counter?", "on counter"},
      {"How many cups are on the table?", "on table --object cups"},
      {"How many red things are there?", "objects 'red things'"},
      {"Is the milk still on the table?", "on table --object milk"},
      {"Which red things are on the counter?", "on counter --object 'red things'"},
      {"Show me everything on the shelf", "on shelf"},
      {"What belongs in the drawer?", "contents-history drawer"},
      {"What is usually kept on the shelf?", "contents-history shelf"},
      {"Was the drawer opened this morning?",
       "changes --between 'this morning' 'this morning' --kind opened --place drawer"},
  });
}

TEST(Sentences, HabitsAndFirstPlaces) {
  expect_commands({
      {"Is the pot in its usual place?", "usual pot"},
      {"Is the tea where it always is?", "usual tea"},
      {"Is the spoon where it belongs today?", "usual spoon --at today"},
      {"Is the oil still where it always is, on the counter?", "on counter --object oil"},
      {"Where was the plate at first?", "history plate --before all"},
      {"How many things were moved today?", "changes --between today today --kind relocated"},
      {"What was not moved today?", "objects --between today today --state unmoved"},
      {"Who cleared the table?", "changes --kind left --place table"},
      {"What is new on the table?", "changes --kind new --place table"},
      {"What is new today?", "changes --between today today --kind new"},
      {"What is different on the table?", "changes --place table"},
      {"Is the tea nearer to the oil or to the pot?", "compare tea --by nearer --than pot --with oil"},
      {"Grab the bowl from the island for me", "task bring 'bowl on island'"},
  });
}

TEST(Sentences, ClaimsAndConditionsAsk) {
  expect_commands({
      {"My wife says the milk is on the table, is that right?", "on table --object milk"},
      {"They told me that the jam is on the shelf", "on shelf --object jam"},
      {"If the milk is still out, tell me where.", "where milk"},
      {"If someone took the banana, tell me when.", "changes --kind left --object banana"},
      {"Where is my cup, the blue one?", "where 'blue cup'"},
      {"whereabouts did the jam go?", "where jam"},
      {"Where is the cooking pot?", "where pot"},
  });
}

TEST(Sentences, TimesInWords) {
  expect_commands({
      {"Where was the cup at 9:00?", "where cup --at 9:00"},
      {"Where was the cup at nine?", "where cup --at nine"},
      {"At 9:00, where was the cup?", "where cup --at 9:00"},
      {"Where was my cup two hours ago?", "where cup --at 'two hours ago'"},
      {"Where was my cup yesterday?", "history cup --between yesterday yesterday"},
      {"Where was the cup this morning?", "history cup --between 'this morning' 'this morning'"},
      {"Where was the cup between nine and ten?", "history cup --between nine ten"},
      {"What was on the table at half past nine?", "on table --at 'half past nine'"},
      {"What was on the table last Monday?", "contents-history table --between 'last monday' 'last monday'"},
      {"Was the red cup on the table between nine and ten?", "was 'red cup' on table --between nine ten"},
      {"Was the red cup on the table from 8:00 to 9:30?", "was 'red cup' on table --between 8:00 9:30"},
      {"Was the milk in the fridge yesterday evening?",
       "was milk on fridge --between 'yesterday evening' 'yesterday evening'"},
      {"What changed since this morning?", "changes --from 'this morning'"},
      {"What happened on the table before noon?", "changes --place table --to noon"},
      {"What did you see between eight and nine?", "objects --between eight nine"},
      {"What changed after 2026-05-01T08:30:00Z?", "changes --from 2026-05-01T08:30:00Z"},
      {"Where is the red one", "where 'red one'"},
      {"Where was the cup at ten past nine?", "where cup --at 'ten past nine'"},
      {"Was the cup on the table yesterday between 8 and 9?",
       "was cup on table --between 'yesterday 8' 'yesterday 9'"},
      {"Did the cup move between 2 and 3 pm?", "changes --between '2 pm' '3 pm' --kind handled --object cup"},
      {"What happened up to 14.30 today?", "changes --to 'today 14:30'"},
      {"What changed since seventeen hundred hours?", "changes --from 17:00"},
      {"What moved over the course of the day?", "changes --between today today --kind relocated"},
      {"Was the cup moved all day?", "changes --between today today --kind handled --object cup"},
      {"What changed after nine and before ten?", "changes --between nine ten"},
  });
}

TEST(Sentences, Tasks) {
  expect_commands({
      {"Could you bring me the milk, please?", "task bring milk"},
      {"Fetch the bowl", "task bring bowl"},
      {"Give us some milk", "task bring milk"},
      {"I would like a banana", "task bring banana"},
      {"Put the milk away", "task stow milk"},
      {"Put away the milk", "task stow milk"},
      {"Put the red cup into drawer_1", "task stow 'red cup' --destination drawer_1"},
      {"Bring the bowl to the table", "task stow bowl --destination table"},
      {"Lay the table", "task set table"},
      {"Clear the table", "task clean table"},
      {"Tidy up!", "task clean"},
      {"Put away everything perishable into the fridge", "task stow perishable --destination fridge"},
  });
}

TEST(Sentences, TheRestIsRefused) {
  for (const char* sentence : {"",
                               "?",
                               " ",
                               "hello",
                               "What is the weather like?",
                               "Sing a song",
                               "How are you?",
                               "the red cup",
                               "where",
                               "what is",
                               "Why is the sky blue?",
                               "'; DROP TABLE object; --",
                               "Set",
                               "on the table",
                               "of the day",
                               "so of the day",
                               "if of the day",
                               "yo of the day",
                               "where, of the day",
                               "Will it rain on Monday?",
                               "Is there",
                               "Bring",
                               "\xff\xfe",
                               "Clean up the kitchen yesterday"}) {
    const auto query = parse_sentence(sentence, kTimes);
    EXPECT_FALSE(query) << sentence << " became " << query->text();
  }
  EXPECT_FALSE(parse_sentence(std::string(100000, 'x'), kTimes));
  EXPECT_FALSE(parse_sentence(
      "where is " + std::string(50, ' ') +
          [] {
            std::string many;
            for (int i = 0; i < 5000; ++i) many += "very ";
            return many;
          }(),
      kTimes));
}

TEST(Sentences, EveryExampleMeansItsQuestion) {
  for (const Question& question : questions())
    for (const SentenceForm& form : question.sentences) {
      if (form.example.empty()) continue;
      std::vector<std::string> meant;  // the memory decides which
      for (const Query& query : parse_readings(clauses_of(form.example, kTimes), kTimes))
        meant.push_back(query.question);
      EXPECT_THAT(meant, testing::Contains(question.name)) << form.example;
    }
}

TEST(Sentences, TheNearestAreNamed) {
  EXPECT_THAT(nearest_examples("Bring tea cup quickly over here me"),
              testing::Contains("Bring me my tea cup."));
  EXPECT_THAT(nearest_examples("Is the couch table with anything"),
              testing::Contains("Is there anything on the couch table?"));
  EXPECT_EQ(nearest_examples("").size(), 3U);
}

TEST(Query, QuotesWhatAShellWouldSplit) {
  EXPECT_EQ((Query{"where", {{"object", "mum's cup"}}}).text(), "where 'mum'\\''s cup'");
  EXPECT_EQ((Query{"where", {{"object", "$(x)"}}}).text(), "where '$(x)'");
}

}  // namespace
}  // namespace loci::memory
