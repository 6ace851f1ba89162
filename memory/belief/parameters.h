#pragma once

#include <array>

namespace loci::memory::belief {

/// Tuned constants of the belief that are not options; options.h has those that depend on sensor and home.
struct Parameters {
  // Visibility
  double unobstructed = 0.5;  ///< share of the frustum a detector without depth sees: it reports no occlusion
  double footing_m = 0.02;    ///< lowest part of a box, which merges with the supporting surface …
  double footing_share = 0.4;  ///< … at most this share of its height
  double min_sigma_m = 0.005;  ///< position uncertainty below this is not sampled: less than a pixel
  // Detection of what is partly hidden. Of objects of simulated days of which a tenth to two fifths were in
  // view, two thirds were found, of those with more as many as of whole ones. In a video the parts that are
  // found vary from frame to frame, and what is missed there would be gone.
  double min_detectable = 0.05;  ///< of views a second apart: below this share in view nothing is detected …
  double detectable_range = 0.25;         ///< … and this much above it a detector works as usual
  double min_detectable_in_video = 0.15;  ///< the same where scenes follow within half a second
  double detectable_range_in_video = 0.45;

  // Prediction and absence
  double base_appearance_change = 0.002;  ///< per view, even without motion: glare, shadows
  double turn_motion = 0.5;               ///< m + rad of camera motion after which another side is visible
  double pose_error_motion = 0.1;         ///< m + rad after which the pose error has its full size
  double occupied_if_gone = 0.1;          ///< probability that an empty spot measures as occupied
  double flat_height_m = 0.015;           ///< up to this height an object merges with the surface's noise …
  double flat_height_range_m = 0.02;      ///< … from this much higher on it is detected as usual
  double flat_detection = 0.4;            ///< detection factor of flat objects
  double min_independence = 0.05;  ///< views within a second repeat each other's errors: a view counts by
                                   ///< its distance in seconds, from this up to 1

  // Position evidence
  double max_log_evidence = 30;    ///< of one pair: no sensor model is exact beyond
  double other_print = -3;         ///< log ratio of staying unchanged where the same side shows another print
  double joined_cluster = 0.1;     ///< share of clusters that hold parts of other objects
  double vertical_noise_m = 0.01;  ///< heights vary with the segmentation of the supporting surface
  double min_extent_log_ratio = -6;    ///< parts may be occluded unnoticed
  double extent_noise_m = 0.01;        ///< of the extent between two views …
  double extent_noise_per_size = 0.1;  ///< … and relative to the size
  double out_of_view = 0.99;           ///< an object this far out of view is not about the observed places

  // Single-cue trackers: largest distance of a proposal, by position (m), extents and colour
  std::array<double, 3> max_tracker_distance{0.1, 0.25, 0.6};
  double tracker_margin_m = 0.05;  ///< anything else must be twice as far and this much more
  double tracker_reach_m =
      0.25;  ///< = 2 · max_tracker_distance[0] + tracker_margin_m: nothing beyond matters

  // Video
  double piece_volume = 0.5;          ///< an observation below this share of a predicted box …
  double piece_covered = 0.6;         ///< … and inside it by this share is a piece of that object
  double merged_in_video = 0.3;       ///< weight of "taken by another object": touching objects often merge
  double piece_in_snapshot = 0.1;     ///< weight of pieces as clutter where no video shows the rest
  double covered = 0.4;               ///< an observation covered this far by a prediction is that object …
  double max_covering_volume = 3;     ///< … unless it is this much larger …
  double min_color_log_ratio = -2.5;  ///< … or has another colour
  double merged_volume = 1.4;         ///< a cluster that grew this much contains its neighbour

  // Detection: of objects of simulated kitchens that 175, 250, 350 and 500 pixels showed, 17, 33, 65 and
  // 95 % were found
  double filled_silhouette = 0.75;  ///< share of a box's silhouette that the object in it fills
  double resolved_pixels = 300;     ///< that show an object of which half are found
  double resolved_steepness = 5;    ///< how fast that grows with the number of pixels

  // Association
  double gate = 1e-4;              ///< a tenth of min_probability: the error stays below what is reported
  double min_probability = 0.001;  ///< of a reported partner
  double min_alternative = 0.02;   ///< of an alternative identity that is carried on
  double min_alternative_hypothesis = 2e-4;  ///< of an alternative hypothesis that is kept
  double min_hindsight_log_ratio = 0.7;      ///< twice as probable: a decision is not changed for less
  size_t hindsight_advances = 2000;          ///< scenes that looking back may reason about: bounds its time
  double excluded = -200;              ///< log weight of what a known identity excludes: beyond all evidence
  double misleading_partial = 0.3;     ///< Corrections::misleading_partial of views that are apart
  double newview_color_weight = 0.25;  ///< another side may have other colours, though seldom altogether

  // One object as several
  double further_pieces = 0.02;      ///< expected of an observed object, beside what it is found as
  double max_piece_color = 3;        ///< log ratio: other objects have the same colours, too
  double min_footprint_m2 = 1e-4;    ///< of an object
  double double_covered = 0.7;       ///< share of a believed box that a whole view of another object covers
  double is_double_log_odds = -100;  ///< of existing

  // Existence
  double cut_off_log_odds = 0.5;  ///< a cut-off cluster is less certainly an object
  double min_sighting = 0.5;      ///< what being found again at once counts: such frames repeat their errors
  double max_sighting = 2;        ///< the same, a second later
  double repeat_clutter_in_video = 0.4;  ///< at least: frames in a row make the same mistakes
  double patience = 12;  ///< in a video, what was found repeatedly waits this many times longer for a view
  double max_log_odds = 20;   ///< of existing: evidence against must still count
  double min_observed = 0.3;  ///< a spot must be observed this much before absence counts …
  double mostly_displaced =
      0.5;                  ///< … or of the surface that would be in view more than this be seen through
  double seen_empty = 0.7;  ///< from this share on an empty spot counts …
  double seen_empty_factor = 1.1;  ///< … this much more than a missed detection

  // Fusion of views
  double max_resize_deviations = 2;  ///< of the extent between two views: farther, one view moves no face
  double grow_gain = 0.5;            ///< another view point shows further parts: boxes grow quickly …
  double shrink_gain = 0.05;         ///< … and shrink slowly
  double min_variance_share = 0.25;  ///< of one view's: errors of one view point repeat
  double same_view_log_ratio = 2.5;  ///< views at least this similar are stored once
  double whole_view_bonus = 5;       ///< in views: whole ones are stored rather than partial ones
  size_t surface_points = 200;       ///< of an object's surface that are kept
  size_t textures = 4;               ///< sides of an object whose texture is kept …
  double same_side_deg = 30;         ///< … of view points farther apart than this
  double certain_partner = 0.9;      ///< a moved object is known so surely before another side is learned

  // Learning
  double similarity_weight = 0.5;  ///< of one comparison: views of one object repeat each other
  double detection_prior = 20;     ///< views that the stated rate of detection is worth
  double min_place_share = 0.05;   ///< of a place that a scene must show to be a view of it
  double min_place_extent_m = 0.5;
  double max_appearance_change = 0.95;
  double view_point_ratio = 4;    ///< variance to be learned over the known one from which a view teaches
  double noise_prior = 3;         ///< offsets that the stated noise is worth
  double noise_memory = 300;      ///< offsets after which evidence of the noise counts for 1/e
  double calibration_prior = 30;  ///< distances that the tables of comparisons() are worth
  double calibration_spread = 1;  ///< of the logarithm of the distances' scale
  float calibration_max = 10000;  ///< counts beyond this fade by half

  // Interaction
  double exchange_share = 0.05;  ///< of what is moved, put down where another object stood
  double prior_events = 2;       ///< events at the expected rate that the options are worth
  double prior_carried_off = 1;  ///< without evidence a third of what is handled is carried off, …
  double prior_put_down = 2;     ///< … the rest is put down, half of it on the same place
  double hazard_tail = 0.15;     ///< slow tail of the rate of handling: nothing stays forever …
  double hazard_tail_time = 24;  ///< … in multiples of move_time_s
  double max_probability = 0.9;  ///< of returning and of being clutter
  double handled_per_use = 0.3;  ///< objects in a drawer that are handled when it is opened or shut
  double use_motion = 0.03;      ///< m + rad by which a place moves when it is used
};

inline constexpr Parameters kParameters;

}  // namespace loci::memory::belief
