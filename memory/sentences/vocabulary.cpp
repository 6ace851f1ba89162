#include "memory/sentences/vocabulary.h"

namespace loci::memory::vocabulary {
namespace {

constexpr Lemma kLemmas[] = {
    // Auxiliaries.
    {"is", "am are be being"},
    {"was", "were"},
    {"do", "does doing"},
    {"have", "has having"},
    {"may", "can could might shall would must"},
    {"should", "ought supposed"},
    {"will", "gonna"},
    {"not", "never no nobody none neither nor without nowhere ain't"},
    {"someone",
     "i we you ya u he she me us him myself ourselves yourself yourselves themselves himself herself one's "
     "anyone anybody somebody people everybody everyone robot person persons folks guys loci visitor "
     "visitors guest guests housemate flatmate roommate husband wife mum mom dad mother father son "
     "daughter grandma grandpa kid kids child children family carer caregiver nurse cleaner man woman boy "
     "girl"},
    {"every", "all both each entire"},
    {"everything", "whatever"},
    {"thing",
     "things object objects item items stuff anything something article articles entity entities "
     "belongings thingy"},
    {"room", "here kitchen flat apartment house home household place's"},
    // What happens.
    {"see",
     "sees saw seen seeing notice noticed noticing notices spot spotted spots observe observed observing "
     "observes detect detected detects detecting recognise recognised recognises recognize recognized "
     "recognizes sighted sighting sightings observation observations glimpse glimpsed witness witnessed "
     "sight count counts counted counting perceive perceived perceives view views viewing detection "
     "detections register registered "
     "registers track tracked logged recorded identify identified spied appearance appearances"},
    {"find", "finds found finding locate locates search searching seek seeking hunting discover discovered"},
    {"look",
     "looks looked looking viewed check checks checked checking inspect inspected inspects examine examined "
     "visited visit visits visiting scan scanned peek peeked"},
    {"move",
     "moves moved moving touching handling movement movements shift shifted shifts shifting push pushed "
     "pushes touch touched touches handle handled handles relocate relocated relocates displace displaced "
     "budge budged budges carried disturb disturbed disturbs transfer transferred rearranged rearrange "
     "reposition "
     "repositioned nudge nudged slide slid drag dragged swap swapped relocation relocations displacement "
     "displacements migrate migrated moved used use uses using tampered fiddled messed interfered meddled"},
    {"take",
     "takes took taken taking remove removes removed removing steal stole stolen steals grab grabbed grabs "
     "pinch pinched pick picked picks swipe swiped borrow borrowed borrows withdrawn nick nicked snatch "
     "snatched lift lifted collect collected extract extracted removal pilfered whipped"},
    {"leave", "leaves left leaving depart departs departed departure exit exited exits"},
    {"go", "goes went gone going wander wandered travel travelled traveled travels"},
    {"vanish",
     "vanishes vanished vanishing disappear disappears disappeared disappearing disappearance evaporated"},
    {"come",
     "comes came coming enter entered enters entering entry arrive arrived arrives arriving arrival appear "
     "appears appeared appearing reach reaches reached return returned returns returning emerged emerge "
     "materialised materialized"},
    {"put",
     "puts placed placing putting laid add added adds brought deposit deposited drop dropped drops park "
     "parked stash stashed stick stuck insert inserted placement plonk plonked dump dumped tuck tucked "
     "plop plopped shove shoved pop popped lodged"},
    {"lose", "lost losing loses misplace misplaced mislay mislaid"},
    {"miss", "missing absent lacking lack lacks lacked"},
    {"keep", "keeps kept keeping store stores stored storing storage"},
    {"stand",
     "stands stood standing lie lies lying lain sit sits sat sitting rest rests rested resting stay stays "
     "stayed staying remain remains remained remaining located situated positioned "
     "reside resides resided residing spent spend spends perched perching lurking lurk lurks dwell "
     "dwells laying present remaining sits parked hang hangs hanging linger lingered waiting "
     "visible available findable locatable"},
    {"hide", "hides hid hidden hiding"},
    {"belong", "belongs belonged live lives lived"},
    {"contain", "contains contained containing hold holds held holding include includes"},
    {"happen",
     "happens happened happening occur occurs occurred event events activity activities happenings"},
    {"change",
     "changes changed changing changeover different altered alteration alterations difference differences"},
    {"own", "owns owned owner owners"},
    {"open", "ajar unclosed"},
    {"opened", "opens opening openings unlocked"},
    {"close", "closed closes closing shut shuts shutting closure"},
    {"know", "knows knew remember remembers recall recalls aware known recollect"},
    {"think",
     "believe say says suppose assume reckon claim thinks believed conclude concluded conclusion infer "
     "inferred figure guess assert asserted decide decided estimate estimated thought said claimed presume"},
    {"get", "got gets gotten getting"},
    {"exist", "exists existing existed"},
    {"want", "need wants needs require"},
    {"act", "done"},
    {"bring", "fetch"},
    // How things are.
    {"empty", "free clear unoccupied vacant bare cleared emptied uncluttered"},
    {"full", "occupied cluttered crowded"},
    {"clean", "tidy straighten"},
    {"usually",
     "normally always mostly typically generally often usual normal customarily commonly ordinarily "
     "regularly habitually routinely generally"},
    {"last", "latest final recent finally lastly"},
    {"lately", "recently"},
    {"before", "previously earlier formerly beforehand"},
    {"first", "earliest initially originally initial"},
    {"afterwards", "after afterward subsequently thereafter"},
    {"sure", "certain confident convinced positive"},
    {"only", "solely merely"},
    {"alone", ""},
    {"nolonger", ""},
    {"nearest", "closest"},
    {"farthest", "furthest"},
    {"nearer", "closer"},
    {"bigger", "larger greater"},
    {"taller", "higher"},
    {"smaller", "tinier littler"},
    {"back", "again"},
    {"away", "aside"},
    // What is asked for.
    {"location", "position spot whereabouts place locations positions pose coordinates"},
    {"content", "contents inventory"},
    {"colour", "color hue shade colours colors coloured colored"},
    {"state", "status condition states"},
    {"scene", "scenes"},
    {"summary", "overview recap summarise summarize"},
    {"write", "written"},
    {"print", "printed"},
    {"size", "dimensions dimension measurements height width length sizes"},
    {"history", "journey trajectory trail"},
    // Relations.
    {"on", "upon atop"},
    {"in", "inside"},
    {"into", "onto"},
    {"near", "nearby around by"},
    {"nextto", "beside alongside"},
    {"under", "below beneath underneath"},
    {"from", "off"},
    {"about", "regarding concerning"},
    {"except", "besides excluding"},
};

constexpr Compound kCompounds[] = {
    // How much, how long.
    {"[the] (number|count|quantity|amount|total) of (times|occasions)", "howoften"},
    {"[on] how many occasions", "howoften"},
    {"[the] (number|count) of (moves|movements|relocations|displacements|(place|location|position) changes)",
     "howoften move"},
    {"[the] (number|count) of openings", "howoften opened"},
    {"(object|item|thing|objects|items|things) count", "howmany things"},
    {"[the] (number|count) of (closings|closures)", "howoften close"},
    {"how many (moves|movements|relocations|(place|location|position) changes)", "howoften move"},
    {"how many openings", "howoften opened"},
    {"how (many times|often|frequently)", "howoften"},
    {"how many (different|distinct|other|more)", "howmany"},
    {"how (many|much) of (the|my|our|these|those|them)", "howmany"},
    {"how many", "howmany"},
    {"how (likely|probable|certain|sure) is it [that]", "howsure"},
    {"how much", "howmuch"},
    {"(count|number) [all] (the|my|our)", "howmany"},
    {"[the] (number|count|quantity|total) of", "howmany"},
    {"(for how many|how many) (hours|minutes|days|mins)", "howlong"},
    {"(for how|how) long", "howlong"},
    {"(how much|what length of|what amount of) time", "howlong"},
    {"[the] duration of", "howlong"},
    {"(since|from|as of|starting|beginning) (when|(what|which) (time|hour|moment|point)) [on|onwards]",
     "sincewhen"},
    {"since how (long|much time)", "howlong"},
    {"(until|till|to|up to|up until) (when|(what|which) (time|hour|moment|point))", "untilwhen"},
    {"how late", "untilwhen"},
    {"(with|to) what (certainty|confidence|probability|degree of certainty)", "howsure"},
    {"what (certainty|confidence|probability|likelihood|chance|odds) (do|would|can|could|did|have) you "
     "(assign|give|attach|put|attribute|estimate|have|see) [to|on|for|in|that|of]",
     "howsure"},
    {"how (big|large|small|tall|high|wide|broad|thick|thin)", "howbig"},
    {"how (far|wide) open", "howfar open"},
    {"how (far|close) (apart|away)", "howfar apart"},
    {"(how far|how close)", "howfar"},
    {"[the] [euclidean] distance", "distance"},
    {"more (things|objects|items|stuff)", "morethings"},
    {"(is|are) there more on", "is there morethings on"},
    {"(is|are) there more in", "is there morethings in"},
    {"how (sure|certain|confident|probable|likely)", "howsure"},
    {"[what is|what are|give|state|report] [the|your] "
     "(probability|chance|chances|likelihood|odds|confidence|certainty|belief) (that|of|for|in|about)",
     "howsure"},
    // When.
    {"(at|around|by|about|in|on|during) (what|which) (time|hour|moment|minute|point|date|day)", "when"},
    {"(what|which) (time|hour|moment|point in time)", "when"},
    {"[the] (time|timestamp|moment|hour|date|point in time) (of|when|at which)", "when"},
    {"by when", "when"},
    {"between (which|what) [two] (observations|looks|scenes|sightings|views|frames|visits|times|moments)",
     "when"},
    {"how recently", "when last"},
    {"[the] last time [that|when]", "last"},
    {"[the] (latest|final) time", "last"},
    {"[the] first time [that|when]", "first"},
    {"for the last time", "last"},
    {"for the first time", "first"},
    {"(is it|has it been|it is) since", "is ago"},
    {"how long since", "howlong ago"},
    {"a quarter (to|till|before)", "quarter to"},
    {"a quarter (past|after)", "quarter past"},
    {"most (recent|recently)", "last"},
    {"(least|longest) recently", "first"},
    {"(most|much) of the (time|day)|for the most part", "usually"},
    {"(every|each) day", "usually"},
    // Where.
    {"(in|at|on) (what|which) (place|spot|location|position|surface)", "where"},
    {"(what|which) (place|spot|location|position|surface) (is|was|has|does|did|do)", "where is"},
    {"(what|which) (place|spot|location|position|surface|places|spots|locations|surfaces)", "where"},
    {"where (abouts|about|exactly|precisely)", "where"},
    {"[all|every] [of] the (places|spots|locations) (where|in which|at which|that)", "where"},
    {"whereabouts (is|are)", "where is"},
    {"whereabouts (was|were)", "where was"},
    {"whereabouts (do|does)", "where do"},
    {"whereabouts did", "where did"},
    {"whereabouts (has|have)", "where have"},
    {"whereabouts (can|could|would|might|should)", "where may"},
    {"where (on earth|in the world|the (hell|heck|devil))", "where"},
    {"who (on earth|in the world)", "who"},
    {"what (on earth|in the world)", "what"},
    {"why (on earth|in the world)", "why"},
    {"when (on earth|in the world)", "when"},
    {"how (on earth|in the world)", "how"},
    {"in (cm|centimetres|centimeters|metres|meters|percent|litres|inches)", ""},
    {"[on] a scale (of|from) [zero|0|one|1] to (ten|10|100|hundred)", ""},
    {"(have|had|has|having) [your|my] eyes on", "see"},
    {"where in the (kitchen|room|house|flat|apartment)", "where"},
    {"anywhere else", "elsewhere"},
    {"somewhere else", "elsewhere"},
    {"(any|some) other place", "elsewhere"},
    // Why.
    {"(how come|for what reason|on what grounds|on what basis|based on what|for which reason|what for)",
     "why"},
    {"what (makes|made|leads|led|makes it that) (you|someone) [to]", "why someone"},
    {"what makes", "why"},
    {"[what is|is there any|is there|give|show|state] [the|your] "
     "(evidence|proof|reason|reasons|justification|grounds|basis) (that|for|of|behind)",
     "why"},
    {"(at|in|on) (its|their|the|his|her) (usual|normal|regular|customary|accustomed|proper|right) "
     "(place|spot|position|location|home)",
     "asusual"},
    {"[back] where (it|they) [always|usually|normally|really] (belong|belongs|live|lives)", "asusual"},
    {"where (it|they) (always|usually|normally|generally|typically) "
     "(is|are|was|were|stand|stands|sit|sits|lie|lies|go|goes)",
     "asusual"},
    {"where (it|they) should be", "asusual"},
    {"where (it|they) (is|are) (supposed|meant) to be", "asusual"},
    {"as (usual|always)", "asusual"},
    {"(out of|not (in|at)) (its|their|the) (usual|normal|regular|customary|accustomed|proper|right) "
     "(place|spot|position|location|home)",
     "outofplace"},
    {"everything (in|at|on) (its|their|the right) (place|places)", "everything asusual"},
    {"out of place|not where (it|they) (belong|belongs)", "outofplace"},
    {"not where (it|they) (usually|normally) (is|are|belong|belongs)", "outofplace"},
    // Colours by the names of mapping::color_name().
    {"violet|lilac|mauve|magenta", "purple"},
    {"crimson|scarlet|maroon", "red"},
    {"turquoise|teal|navy", "blue"},
    // Verbs of several words.
    {"(track|tracking) down", "find"},
    {"(looking|look|looks|search|searching|searches|hunt|hunting|hunts) [everywhere|around] for", "find"},
    {"(come|came) across", "see"},
    {"(set|laid|lay|clap|clapped) eyes on", "see"},
    {"catch sight of", "see"},
    {"(ended|end|ends|wound|wind) up", "go"},
    {"(turned|turn|turns|showed|show|shows) up", "come"},
    {"(become|became|becomes) of", "happen to"},
    {"(take|took|takes|taken|taking) place", "happen"},
    {"(change|changed|changes|swap|swapped) "
     "(place|places|position|positions|location|counters|tables|shelves|drawers|surfaces)",
     "move"},
    {"(moved|relocated|shifted|carried|transferred) to (another|a different|some other) "
     "(place|spot|location|surface|counter|table|shelf|drawer)",
     "moved"},
    {"(visit|visits|visited)", "come to"},
    {"(ever|last) [been|stood] [completely|totally|entirely|fully|quite] (empty|bare|free|clear)",
     "everempty"},
    {"in the course of", "during"},
    {"if only for (a|one) (while|moment|minute|time|bit)|(even|if) only (briefly|shortly)", ""},
    {"(play|playing|played|fiddle|fiddling|fiddled|mess|messing|messed|tamper|tampering|tampered|meddle|"
     "meddling|meddled|interfere|interfered) [about|around] with",
     "move"},
    {"(pull|pulled|pulling|pulls|slide|slid) (out|open) (the|a|any|my|that|this)", "opened the"},
    {"(pull|pulled|pulling|pulls|slide|slid) (out|open) drawer", "opened drawer"},
    {"(something|anything) to drink (from|out of)", "any cup"},
    {"(something|anything) to eat with", "any cutlery"},
    {"(something|anything) to drink", "any drink"},
    {"(something|anything) to eat", "any food"},
    {"(piece|pieces|bit|bits|item|items) of furniture", "place"},
    {"(piece|pieces|bit|bits) of", ""},
    {"(go|gone|went|travel|travelled) anywhere", "move"},
    {"(pull|pulls|pulled|slid|drawn) out of", "take from"},
    {"(pulled|slid|drawn) (out|open)", "opened"},
    {"(go|gone|went|going) (missing|walkabout|astray)", "vanish"},
    {"(go|gone|went|going|goes) wrong", "wrong"},
    {"[is|are] (used up|finished|all gone)", "is gone"},
    {"(are|is) (we|you) [all] out of", "is gone"},
    {"(have|has|did) (we|you) (run|ran|run all|all run) out of", "is gone"},
    {"[going|goes|went|gone] on with", "happened with"},
    {"(going|goes|gone) on", "happening"},
    {"went on", "happened"},
    {"(lay|laid|put|set|placed) down", "put"},
    {"get rid of", "take"},
    {"make room", "room"},
    {"used to be", "was"},
    {"(is|are|was|were) (supposed|meant) to", "should"},
    // Statements and their claims.
    {"(would|do) you (say|think|believe|reckon) (is|are|was|were)", "is"},
    {"which of (the|my|our|your|these|those|them) (two|three|four|five|six)", "which"},
    {"(one|any|some|either|each|all|both|none|several|most) of (the|my|our|your|these|those|them) "
     "(two|three|four|five|six)",
     "any"},
    {"all of (the|my|our|your|these|those|them)", "all the"},
    {"all (two|three|four|five|six|seven)", "all the"},
    {"both of (the|my|our|your|these|those|them)", "both the"},
    {"(none|neither) of (the|my|our|your|these|those|them)", "no"},
    {"(one|any|some|either|each|several) of (the|my|our|your|these|those|them)", "any"},
    {"which of (the|my|our|your|these|those|them)", "which"},
    {"which of", "which"},
    {"which one [of the]", "which"},
    // Relations.
    {"(to|on) the left [hand] [side] of", "leftof"},
    {"(to|on) the right [hand] [side] of", "rightof"},
    {"left of", "leftof"},
    {"right of", "rightof"},
    {"on top of", "on"},
    {"(close to|in the vicinity of|in the neighbourhood of|close by)", "near"},
    {"[right|directly|immediately] (next to|adjacent to|beside|alongside)|right by|hard by", "nextto"},
    {"(most|more) (near|close)", "nearest"},
    {"more (big|large)", "bigger"},
    {"more (small|little)", "smaller"},
    {"more (tall|high)", "taller"},
    {"[all] (on|by) (its|their|his|her) own", "alone"},
    {"[all] by (itself|themselves|himself|herself)", "alone"},
    {"(do|does) someone (have|need) to (close|shut)", "are open"},
    {"(do|does) (i|we|you) (have|need) to (close|shut)", "are open"},
    {"(nearest|closest) (to|from|by)", "nearest near"},
    {"(most distant|farthest away|furthest away)", "farthest"},
    {"different (colours|colors)|(a|another) different (colour|color)", "differentcolour"},
    {"back (where|to where) (it|they) (was|were|is|are|came from)", "back"},
    {"(out of|off of|away from)", "from"},
    {"[back] (into|onto)", "into"},
    {"in front of", "infront"},
    {"(whose|with) [the] (support|location|place|position) (is|are|being)", "on"},
    {"(supported|carried) by", "on"},
    {"(apart|aside|other) (from|than)", "except"},
    {"not counting", "except"},
    {"except for", "except"},
    {"(with the exception|exclusive) of", "except"},
    {"such as", "like"},
    {"similar to", "like"},
    {"(resemble|resembles|resembling)", "look like"},
    {"(is|was|has been|are|were) in use", "is full"},
    {"open or (closed|shut)", "state"},
    {"(closed|shut) or open", "state"},
    {"(anything|something) (else|other|more)", "something else"},
    {"[the] most (often|frequently|times)", "mostoften"},
    {"[the] most (moves|movements|relocations|(place|location|position) changes)", "mostoften move"},
    {"[the] most openings", "mostoften opened"},
    {"[the] most (things|objects|items|stuff|crowded|cluttered|occupied|full)|[the] (fullest|busiest)",
     "mostthings"},
    {"[the] longest (stay|time)|for the longest [time]", "longesttime"},
    {"more than (once|one time)|at least (twice|two times)|(several|multiple|many|repeated) times|repeatedly|"
     "over and over [again]|again and again",
     "repeated 2"},
    {"more than (twice|two times)|at least (thrice|three times)", "repeated 3"},
    {"more than three times|at least four times", "repeated 4"},
    {"(but|and|that|which) (is|are|was|were|have|has) (not|no longer|no more) (here|there|around|present) "
     "[now|anymore]",
     "vanished"},
    {"(but|and) (no longer|not) (is|are) (here|there|around|present) [now|anymore]", "vanished"},
    {"(is|are) (not|no longer) (here|there|around|present) [now|anymore]", "is gone"},
    {"any more", "anymore"},
    {"(no longer|no more)", "nolonger"},
    {"(prior|previous) to", "before"},
    {"at least (one|1)", "a"},
    {"at least (two|2)", "two"},
    {"at least (three|3)", "three"},
    {"at least (four|4)", "four"},
    {"not ever", "not"},
    {"any longer", "anymore"},
    {"of the day", ""},
    {"(summarize|summarise) (the|my|this) day", "summary"},
    {"life cycle", "lifecycle"},
    {"[at] (the|a) same (place|spot|location|position)", "together"},
    {"in (the|one) same (place|spot|location|position|drawer)", "together"},
    {"side by side", "together"},
    {"at (the|one) (same|very same) (time|moment)|simultaneously|at one time|at once", "together"},
    {"(the|a|one) (same|identical) (colour|color)|alike in (colour|color)", "samecolour"},
    {"(the|a|one) (same|identical) (size|sizes)|equally (big|large)", "samesize"},
    {"more than one", "two"},
    {"more than two", "three"},

    {"in one place", "together"},
};

constexpr ClassWords kClasses[] = {
    {WordClass::question,
     "where when who whose why what which how howmany howlong howoften howsure howbig howfar howmuch "
     "sincewhen untilwhen"},
    {WordClass::auxiliary, "is was been do did have had may should will"},
    {WordClass::person, "someone"},
    {WordClass::article, "the a an my our any some his her their your its these those"},
    {WordClass::empty,
     ", please still already ever just currently really also even maybe then right yet actually perhaps "
     "anyway kindly possibly exactly precisely indeed simply anymore total overall presently anywhere "
     "somewhere too well apparently basically supposedly seem seems so certainly up down out "
     "definitely surely probably obviously honestly frankly properly safely quickly quick accidentally "
     "somehow likely perchance around altogether such kind sort own's very meanwhile though although sat "
     "accessible reachable own's yes"},
    {WordClass::relation,
     "on in at to into from of near nextto with behind under infront leftof rightof above about for and or "
     "like "
     "within between "
     "than as over except repeated"},
    {WordClass::ordinary,
     "because if whether unless while much nice good bad better worse best nicest old young tomorrow "
     "soon later early late far more most less least fewer almost nearly twice once per "
     "weather joke song meaning news time date day days week year name language sky rain sun moon world "
     "speak sing dance eat eats ate eaten eating drank drunk drinking cook cooks cooked cooking "
     "bake baked sleep sleeps slept sleeping buy buys bought cost costs price expensive cheap "
     "hungry thirsty tired hot cold warm weigh weighs weighed broken broke break breaks dirty fresh sour "
     "sweet expired spoiled rotten wet dry washed wash washes washing clean's boil boiled burn burnt burned "
     "melt melted freeze frozen cut cuts chop chopped pour poured spill spilled spilt stir peel peeled "
     "hello hi hey bye thanks sorry okay ok let's cannot feel feeling love hate work works "
     "working stop start started play plays played doing make made making makes enough instead unlike due "
     "until since during against toward towards across along beyond despite beautiful ugly favourite "
     "favorite wrong shortly after whenever wherever whoever whichever predict forecast compute calculate "
     "translate spell switch turn press call ring text email send order pay reboot restart charge update "
     "install download repair fix refill knock knocked hit kick throw threw thrown walk run jump drive fly "
     "swim wear smell taste hear listen watch marry die born win score vote dial remind schedule "
     "cancel pause shop but plus minus times divided equals percent degrees temperature president capital "
     "riddle "
     "recipe poem story firmware battery wifi internet volume alarm timer"},
};

constexpr SurroundingWords kSurroundings[] = {
    {kAddress,
     "robot dear mate buddy pal darling sweetheart sweetie sir madam ma'am computer assistant machine "
     "loci friend dude bro guys folks man folk chap fella lad alexa siri jarvis"},
    {kAddress | kIntroduction, "love"},
    {kPolite,
     "thanks thank morning evening afternoon day yes one more back thing question another listen pardon now "
     "then by way no young "
     "very much hurry cheers bye alright everyone greetings honestly anyway wait hold hang sec oops damn "
     "god goodness heavens come course still honest fact fine"},
    {kPolite | kIntroduction,
     "excuse someone please hello hi hey sorry ok okay good well so quick quickly question a and the "
     "near not if may do just my old mind is it for help you in about curious there second moment bother "
     "to of be actually great"},
    {kPolite | kIntroduction | kClaim, "right correct tell think know see"},
    {kIntroduction,
     "was been will did have had want ask asking wonder wondering interested find out figure work try "
     "trying remember like forget forgot forgotten idea clue any chance look up explain as on hope "
     "hoping possible able telling an happen show remind give let what but hint need inform clear yet "
     "also really possibly kind enough memory your perhaps maybe kindly this would information empty "
     "point hear understand advise nice lovely helpful grateful appreciate thankful glad happy wish "
     "should minute me us some idea's notion guess faintest slightest at all with from could can might "
     "use head answer asked wondered that's thing brain learn nosy worried concerned puzzled confused "
     "trouble somebody interest determine establish"},
    {kIntroduction | kClaim, "sure say confirm true case report state verify check assume"},
};

}  // namespace

std::span<const Lemma> lemmas() {
  return kLemmas;
}
std::span<const Compound> compounds() {
  return kCompounds;
}
std::span<const ClassWords> classes() {
  return kClasses;
}
std::span<const SurroundingWords> surroundings() {
  return kSurroundings;
}

const char* const kFurniture =
    "table counter worktop countertop shelf shelves drawer drawers island cupboard cupboards cabinet "
    "cabinets door doors fridge refrigerator freezer oven stove hob cooker microwave dishwasher toaster "
    "kettle sink tap bin wardrobe pantry larder sideboard bench chair chairs stool sofa couch bed desk "
    "window windowsill floor wall ceiling hall hallway bathroom bedroom balcony garden garage cellar "
    "basement attic lounge dining living";

const char* const kHouseholdWords =
    // Things.
    "cup cups mug mugs glass glasses plate plates bowl bowls dish dishes saucer saucers tray jug jar jars "
    "bottle bottles can cans tin tins box boxes carton cartons packet packets bag bags basket pot pots pan "
    "pans lid lids ladle whisk spatula knife knives fork forks spoon spoons cutlery crockery cookware "
    "chopsticks grater peeler opener corkscrew tongs sieve colander scissors board boards blender mixer "
    "scale scales thermos flask teapot coffee tea milk water juice beer wine cola soda sugar salt pepper "
    "flour rice pasta noodles bread toast butter cheese yoghurt yogurt cream egg eggs ham bacon sausage meat "
    "chicken fish tuna apple apples pear pears banana bananas orange oranges lemon lemons grape grapes "
    "cherry cherries berry berries melon potato potatoes tomato tomatoes carrot carrots onion onions garlic "
    "lettuce salad cucumber beans peas corn soup sauce ketchup mustard mayonnaise honey jam marmalade "
    "cereal cereals muesli cornflakes oats chocolate biscuit biscuits cookie cookies cake crisps nuts oil "
    "vinegar spice spices herb herbs snack snacks food fruit vegetables groceries medicine pills tablets "
    "towel towels sponge cloth napkin napkins candle candles lighter matches foil paper soap key keys purse "
    "wallet phone mobile charger remote radio lamp torch book books newspaper letter letters pen pencil "
    "umbrella spectacles toy toys teddy bear doll ball dinosaur unicorn plant flower flowers vase clock "
    "laptop tablet camera headphones shoe shoes sock socks hat coat jacket scissors screwdriver hammer "
    // How they are.
    "red green blue yellow black white grey gray brown beige pink purple cyan silver golden violet big small "
    "large little tall short long flat round square wooden plastic metal ceramic biggest largest smallest "
    "tallest shortest longest littlest highest widest narrowest thinnest thickest flattest broadest tiniest "
    "heaviest lightest oldest newest medium tiny huge empty full upper lower top bottom left "
    "middle";

const char* const kOtherWords =
    "i mine yours ours mean whom am must done they ones seven eight nine ten eleven twelve twenty "
    "thirty forty fifty fifteen half quarter past pm today yesterday tonight noon midday midnight "
    "lunchtime teatime night breakfast lunch dinner supper seconds monday tuesday wednesday thursday "
    "friday saturday sunday before because third fourth fifth bring fetch stow pack wipe list describe "
    "clean usually every through throughout";

}  // namespace loci::memory::vocabulary
