#include "memory/belief/options.h"

namespace loci::memory::belief {

void BeliefOptions::declare(OptionTable& table) {
  table.number("noise_m", noise_m, "m", "Noise of a cluster's centre between two views of a static camera.",
               1e-4, 1);
  table.number("noise_per_m2", noise_per_m2, "1/m", "Growth of that noise with the square of the distance.",
               0, 1);
  table.number("noise_per_size", noise_per_size, "", "Noise of the centre as a share of the cluster's size.",
               0, 1);
  table.number("pose_noise_m", pose_noise_m, "m", "Pose error between two views of a moved camera.", 0, 10);
  table.number("view_bias", view_bias, "",
               "Shift of the visible part's centre, as a share of its size, when the view point changed.", 0,
               1);
  table.number("noise_spread", noise_spread, "",
               "How uncertain the noise between view points is: standard deviation of its logarithm.", 0.01,
               3);
  table.number("area_m2", area_m2, "m^2", "Area over which an unrelated object could be anywhere.", 0.01,
               1000);
  table.number("move_time_s", move_time_s, "s",
               "Time after which an object has been handled with most of its final probability.", 1, 1e9);
  table.number("move_cap", move_cap, "",
               "Probability that an object has been handled after a very long time.", 0.01, 0.99);
  table.number(
      "watched", watched, "",
      "Share of the time between video frames that counts: a person who handles objects comes into view.", 0,
      1);
  table.number("nudge_m", nudge_m, "m", "Length of a short move; half of all moves are short.", 0.01, 10);
  table.number("newview", newview, "",
               "Probability that a static object looks different from an opposite view point.", 0, 1);
  table.number("appear", appear, "", "New objects expected in a scene.", 0.001, 100);
  table.number("reappear", reappear, "", "Probability that a gone object is back.", 0, 1);
  table.number("detection", detection, "", "Probability that an object in full view is found.", 0.01, 0.999);
  table.number("clutter", clutter, "", "False clusters expected in a scene.", 1e-6, 100);
  table.number("repeat_clutter", repeat_clutter, "", "Probability that a false cluster is found again.",
               0.001, 0.99);
  table.number("empty_if_there", empty_if_there, "",
               "Probability that the sensor sees through an object that is there (pose and depth errors).",
               1e-6, 0.5);
  table.number("appearance_weight", appearance_weight, "",
               "Factor on the evidence of annotations, since those of one object are not independent.", 0.05,
               1);
  table.flag("settle", settle,
             "Settles observations without the model where the position, shape and colour trackers agree and "
             "nothing else "
             "is near.");
  table.number(
      "snapshot_gap_s", snapshot_gap_s, "s",
      "Scenes farther apart than this cannot confirm each other: their observations are believed at once.", 0,
      1e9);
  table.number("confirm", confirm, "", "Probability of existing from which an object is reported.", 0.5,
               0.9999);
  table.number("first_sight", first_sight, "",
               "Probability that a cluster seen once in a video is an object.", 0.01, 0.99);
  table.number("gone", gone, "", "Probability of not being there from which an object is reported as gone.",
               0.5, 0.9999);
  table.integer("views", views, "", "Views stored per object for comparison.", 1, 100);
  table.integer("gone_kept", gone_kept, "", "Gone objects that can still be recognised when they return.", 0,
                100000);
}

}  // namespace loci::memory::belief
