-- The memory of loci: one SQLite file per memory (*.loci).
--
-- Conventions
--   time      INTEGER, nanoseconds since the Unix epoch, UTC
--   lengths   REAL, metres; frames: map (z up, floor at z = 0), camera optical (x right, y down, z forward)
--   poses     seven columns x, y, z, qx, qy, qz, qw; always target_from_source by the column prefix
--   colour    hue 0 to 360, saturation and value 0 to 1
--   NULL      unset, unknown; never zero or identity
--   ids       INTEGER here; object 12 is "object_12" for people
--
-- Bitemporal tables: association, event, object, belief and fact have valid time (valid_from, valid_to; valid_to
-- NULL = open) and transaction time (known_from, known_to). Rows are only added. A wrong row is not changed: a later
-- row names it in `supersedes`, and from the known_from of that row on the older one is no longer known (the views
-- *_known compute that end as known_to). Probability 0, or a NULL value, retracts a row without replacing it; so does a
-- row in its place that ends to be known when it begins (known_to = known_from).

-- One value per key: format ("loci-memory"), created (ISO 8601), written_by ("loci 0.1.0"), time_zone (in which
-- people mean times: "Europe/Berlin", "UTC", "+02:00"), next_object (ids of objects below it are not given again), digests
-- (of the tables, for verify).
CREATE TABLE meta (
  key TEXT PRIMARY KEY,
  value TEXT NOT NULL
) STRICT;

-- One execution of a program that added rows.
CREATE TABLE run (
  id INTEGER PRIMARY KEY,
  program TEXT NOT NULL,           -- "loci-perceive run"
  version TEXT NOT NULL,           -- "0.1.0"
  configuration TEXT NOT NULL,     -- JSON: the effective configuration
  started INTEGER NOT NULL,        -- known time
  finished INTEGER                 -- known time; NULL = still running or killed
) STRICT;

-- Bytes, stored once per content.
CREATE TABLE blob (
  id INTEGER PRIMARY KEY,
  hash TEXT NOT NULL UNIQUE,       -- SHA-256 of the original bytes, hexadecimal
  media TEXT NOT NULL,             -- "image/jpeg", "image/png", "depth/uint16-mm", "depth/uint16-mm-delta", "pixels/kind", ...
  size INTEGER NOT NULL,           -- original bytes
  encoding INTEGER NOT NULL CHECK (encoding IN (0, 1)),  -- 0 = as is, 1 = zstd
  content BLOB NOT NULL
) STRICT;

-- A map of the static world in which scenes were perceived.
CREATE TABLE map (
  id INTEGER PRIMARY KEY,
  hash TEXT NOT NULL UNIQUE,       -- SHA-256 of URDF and sidecar
  name TEXT NOT NULL,              -- file name
  urdf INTEGER NOT NULL REFERENCES blob,
  sidecar INTEGER REFERENCES blob  -- semantic.json
) STRICT;

-- A named surface or container: a link of a map, or found while perceiving (plane_1, plane_2, ...).
CREATE TABLE place (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL UNIQUE,       -- "table_1"
  class TEXT NOT NULL,             -- table, counter, shelf, drawer, plane, floor, ...
  map INTEGER REFERENCES map,      -- NULL = found without a map
  height REAL,                     -- of the supporting surface above the floor
  outline TEXT,                    -- JSON [[x, y], ...] in the map frame
  x REAL, y REAL, z REAL, qx REAL, qy REAL, qz REAL, qw REAL,  -- map_from_place
  container INTEGER NOT NULL CHECK (container IN (0, 1)),      -- objects are in it rather than on it
  joint TEXT,                      -- the joint that moves it
  known_from INTEGER NOT NULL,
  run INTEGER NOT NULL REFERENCES run
) STRICT;

-- A source of frames, identified by its content.
CREATE TABLE recording (
  id INTEGER PRIMARY KEY,
  fingerprint TEXT NOT NULL UNIQUE,  -- hash of its list of frames
  name TEXT NOT NULL,                -- folder or file name
  kind TEXT NOT NULL,                -- reader: "loci", "7-scenes", ...
  time_assumed INTEGER NOT NULL CHECK (time_assumed IN (0, 1)),  -- its time stamps were made up
  frames INTEGER                     -- their number
) STRICT;

-- One processed frame: what the camera observed at one time.
CREATE TABLE scene (
  id INTEGER PRIMARY KEY,
  recording INTEGER REFERENCES recording,
  frame_index INTEGER,             -- in the recording
  time INTEGER NOT NULL,
  map INTEGER REFERENCES map,
  camera_width INTEGER, camera_height INTEGER,              -- pixels, of the depth camera
  fx REAL, fy REAL, cx REAL, cy REAL,                       -- pixels; pixel centres at integers
  range_min REAL, range_max REAL,                           -- range of the sensor
  x REAL, y REAL, z REAL, qx REAL, qy REAL, qz REAL, qw REAL,  -- map_from_camera; NULL = unknown
  depth INTEGER REFERENCES blob,   -- thumbnail: uint16 little endian, row by row, millimetres of z-depth, 0 = none
  depth_width INTEGER, depth_height INTEGER,                -- of the thumbnail; its intrinsics scale with it
  pixel_kinds INTEGER REFERENCES blob,  -- of the pixels of the thumbnail, one byte each: 0 = not measured,
                                   -- 1 = map-explained, 2 = background, 3 = region of interest; NULL = no map
  image INTEGER REFERENCES blob,   -- JPEG or PNG
  joints TEXT,                     -- JSON {joint: position}
  known_from INTEGER NOT NULL,
  run INTEGER NOT NULL REFERENCES run,
  UNIQUE (recording, frame_index)
) STRICT;
CREATE INDEX scene_time ON scene (time);
-- The rank of scenes 1, 65, 129, ... in order of time. Derived from scene, to count scenes without reading them.
CREATE TABLE scene_rank (
  number INTEGER PRIMARY KEY,      -- rank of the scene in order of time
  time INTEGER NOT NULL,
  scene INTEGER NOT NULL REFERENCES scene
) STRICT;
CREATE INDEX scene_rank_time ON scene_rank (time);

-- The log of a scene: the time of each annotator, and its messages (joints, obstacles, failures).
CREATE TABLE scene_log (
  scene INTEGER NOT NULL REFERENCES scene,
  number INTEGER NOT NULL,         -- of the line, from 0
  annotator TEXT NOT NULL,
  level TEXT NOT NULL,             -- debug, info, warning, error
  text TEXT,                       -- NULL = only the time
  milliseconds REAL,               -- NULL = not measured
  PRIMARY KEY (scene, number)
) STRICT, WITHOUT ROWID;

-- One observation of something in one scene (a cluster), before data association.
CREATE TABLE observation (
  id INTEGER PRIMARY KEY,
  scene INTEGER NOT NULL REFERENCES scene,
  number INTEGER NOT NULL,         -- within the scene, from 0
  place INTEGER REFERENCES place,
  x REAL, y REAL, z REAL,          -- centre, map frame
  box_x REAL, box_y REAL, box_z REAL, box_qx REAL, box_qy REAL, box_qz REAL, box_qw REAL,  -- map_from_box
  size_x REAL, size_y REAL, size_z REAL,                    -- of the box, along its axes
  hue REAL, saturation REAL, value REAL,
  color TEXT,                      -- name of the dominant colour
  points INTEGER,                  -- depth points
  crop INTEGER REFERENCES blob,    -- image of it
  mask INTEGER REFERENCES blob,    -- PNG, 8 bit, of the depth image's region of interest
  roi_x INTEGER, roi_y INTEGER, roi_width INTEGER, roi_height INTEGER,  -- pixels in the depth image
  location TEXT,                   -- where it is, in words
  cloud INTEGER REFERENCES blob,   -- z-depth of each pixel of the mask, row by row, millimetres, 0 = none; the difference
                                   -- d to the pixel before as 2d, or -2d - 1 for d < 0; all low bytes, then all high
  UNIQUE (scene, number)
) STRICT;
CREATE INDEX observation_place ON observation (place);

-- The values of annotations, each once; term_text (FTS5) searches their words.
CREATE TABLE term (
  id INTEGER PRIMARY KEY,
  type TEXT NOT NULL,              -- type name: "loci.Shape", "loci.Text", ...
  value TEXT NOT NULL,
  UNIQUE (value, type)
) STRICT;
CREATE INDEX term_word ON term (value COLLATE NOCASE);
CREATE VIRTUAL TABLE term_text USING fts5(value, content='term', content_rowid='id');
CREATE TRIGGER term_text_insert AFTER INSERT ON term BEGIN
  INSERT INTO term_text (rowid, value) VALUES (new.id, new.value);
END;
CREATE TRIGGER term_text_delete AFTER DELETE ON term BEGIN
  INSERT INTO term_text (term_text, rowid, value) VALUES ('delete', old.id, old.value);
END;

-- An annotation as a searchable value; the complete structure is in feature_structure. The view annotation_value has
-- the text of the term.
CREATE TABLE annotation (
  id INTEGER PRIMARY KEY,
  scene INTEGER NOT NULL REFERENCES scene,
  observation INTEGER REFERENCES observation,  -- NULL = about the scene
  term INTEGER NOT NULL REFERENCES term,
  confidence REAL,                 -- uncalibrated
  feature_structure INTEGER REFERENCES feature_structure
) STRICT;
CREATE INDEX annotation_scene ON annotation (scene, observation);
CREATE VIEW annotation_value AS
  SELECT a.id, a.scene, a.observation, t.type, t.value, a.confidence, a.feature_structure
  FROM annotation a JOIN term t ON t.id = a.term;

-- A type system that feature structures were written with: XML in UIMA's format, or JSON.
CREATE TABLE type_system (
  id INTEGER PRIMARY KEY,
  hash TEXT NOT NULL UNIQUE,
  content INTEGER NOT NULL REFERENCES blob
) STRICT;

-- Any feature structure, with all that it refers to, as canonical JSON.
CREATE TABLE feature_structure (
  id INTEGER PRIMARY KEY,
  scene INTEGER REFERENCES scene,
  observation INTEGER REFERENCES observation,
  type TEXT NOT NULL,              -- type name
  type_system INTEGER NOT NULL REFERENCES type_system,
  encoding INTEGER NOT NULL CHECK (encoding IN (0, 1)),  -- 0 = UTF-8 text, 1 = zstd of it
  content BLOB NOT NULL            -- large arrays are {"blob": HASH}
) STRICT;
CREATE INDEX feature_structure_scene ON feature_structure (scene, type);
CREATE INDEX feature_structure_observation ON feature_structure (observation);
-- Which blobs it refers to.
CREATE TABLE feature_structure_blob (
  feature_structure INTEGER NOT NULL REFERENCES feature_structure,
  blob INTEGER NOT NULL REFERENCES blob,
  PRIMARY KEY (feature_structure, blob)
) STRICT, WITHOUT ROWID;

-- A persistent object, to which observations are associated.
CREATE TABLE object (
  id INTEGER PRIMARY KEY,
  valid_from INTEGER NOT NULL,     -- first seen
  valid_to INTEGER,
  known_from INTEGER NOT NULL,
  known_to INTEGER,
  supersedes INTEGER REFERENCES object,
  run INTEGER NOT NULL REFERENCES run,
  source TEXT NOT NULL             -- "perceive", "ingest", a person's name
) STRICT;

-- Data association: which observation is of which object, with its explanation. The complete distribution, not only
-- its mode. A row without observation is an object that was not matched (disappear, missed, hidden); a row without
-- object is a false detection (clutter).
CREATE TABLE association (
  id INTEGER PRIMARY KEY,
  scene INTEGER NOT NULL REFERENCES scene,
  observation INTEGER REFERENCES observation,
  object INTEGER REFERENCES object,
  explanation TEXT NOT NULL CHECK (explanation IN
    ('stay', 'move', 'newview', 'appear', 'clutter', 'disappear', 'missed', 'hidden')),
  probability REAL NOT NULL CHECK (probability BETWEEN 0 AND 1),
  chosen INTEGER NOT NULL CHECK (chosen IN (0, 1)),  -- 1 = part of the maximum a posteriori (MAP) hypothesis
  valid_from INTEGER NOT NULL,
  valid_to INTEGER,
  known_from INTEGER NOT NULL,
  known_to INTEGER,
  supersedes INTEGER REFERENCES association,
  run INTEGER NOT NULL REFERENCES run,
  source TEXT NOT NULL
) STRICT;
CREATE INDEX association_scene ON association (scene);
-- The observations of an object in order of time.
CREATE INDEX association_object ON association (object, valid_from, scene, observation)
  WHERE chosen = 1 AND observation IS NOT NULL AND probability > 0;
CREATE INDEX association_observation ON association (observation);
CREATE INDEX association_supersedes ON association (supersedes) WHERE supersedes IS NOT NULL;

-- The terms that annotations of an object ever had, and since when. Derived from association and annotation, to find
-- objects by term.
CREATE TABLE object_term (
  term INTEGER NOT NULL REFERENCES term,
  object INTEGER NOT NULL REFERENCES object,
  since INTEGER NOT NULL,          -- time of the first observation with this term
  PRIMARY KEY (term, object)
) STRICT, WITHOUT ROWID;

-- The rank of observations 1, 65, 129, ... of each object in order of time. Derived from association, to count
-- observations without reading them.
CREATE TABLE observation_rank (
  object INTEGER NOT NULL REFERENCES object,
  number INTEGER NOT NULL,         -- rank of the observation in order of time
  valid_from INTEGER NOT NULL,
  scene INTEGER NOT NULL REFERENCES scene,
  PRIMARY KEY (object, number)
) STRICT, WITHOUT ROWID;

-- The places on which an object was observed: one row for each change of place between its observations, until its
-- next row. Derived from association and observation, to find observations on a place.
CREATE TABLE visit (
  object INTEGER NOT NULL REFERENCES object,
  valid_from INTEGER NOT NULL,     -- time of the first observation there
  scene INTEGER NOT NULL REFERENCES scene,
  place INTEGER NOT NULL,          -- 0 = none
  PRIMARY KEY (object, valid_from, scene)
) STRICT, WITHOUT ROWID;
CREATE INDEX visit_place ON visit (object, place, valid_from, scene);

-- What happened.
CREATE TABLE event (
  id INTEGER PRIMARY KEY,
  scene INTEGER REFERENCES scene,  -- in which it was detected
  kind TEXT NOT NULL CHECK (kind IN
    ('appeared', 'moved', 'looks_different', 'gone', 'hidden', 'reappeared', 'joint_changed', 'place_moved')),
  object INTEGER REFERENCES object,
  observation INTEGER REFERENCES observation,
  place INTEGER REFERENCES place,       -- where it is after it
  from_place INTEGER REFERENCES place,  -- where it was before it
  x REAL, y REAL, z REAL,
  from_x REAL, from_y REAL, from_z REAL,
  joint TEXT,                      -- of joint_changed
  position REAL, from_position REAL,    -- of the joint: metres or radians
  probability REAL NOT NULL CHECK (probability BETWEEN 0 AND 1),
  since INTEGER,                   -- it happened after this time (the last look before it) and until valid_from
  valid_from INTEGER NOT NULL,
  valid_to INTEGER,
  known_from INTEGER NOT NULL,
  known_to INTEGER,
  supersedes INTEGER REFERENCES event,
  run INTEGER NOT NULL REFERENCES run,
  source TEXT NOT NULL
) STRICT;
CREATE INDEX event_time ON event (valid_from);
CREATE INDEX event_object ON event (object, valid_from);
CREATE INDEX event_scene ON event (scene);
CREATE INDEX event_supersedes ON event (supersedes) WHERE supersedes IS NOT NULL;

-- The belief about an object from a scene on, until its next row. A row is only added for a significant change: a new
-- object, gone or back, another place, another appearance, a position farther off than 5 mm and its sigma, a size
-- different by 1 cm and a tenth, a probability different by 0.05. In between
--   an observation (association) means that it is there with probability 1,
--   a probability p becomes p * (fade_to + (1 - fade_to) * exp(-t / fade_s)) after t seconds,
--   the status follows from the latest scene: seen (association, until a minute after it), missed or hidden
--   (visibility), else out_of_view.
-- The size is its length, width and height by all views.
CREATE TABLE belief (
  id INTEGER PRIMARY KEY,
  object INTEGER NOT NULL REFERENCES object,
  scene INTEGER REFERENCES scene,
  status TEXT NOT NULL CHECK (status IN ('seen', 'missed', 'hidden', 'out_of_view', 'gone')),
  probability REAL NOT NULL CHECK (probability BETWEEN 0 AND 1),  -- that it still is at this place
  place INTEGER REFERENCES place,
  x REAL, y REAL, z REAL,          -- where it is believed to be, map frame
  sigma REAL,                      -- standard deviation of that position
  last_scene INTEGER REFERENCES scene,              -- of its last observation
  last_observation INTEGER REFERENCES observation,  -- its last observation
  hue REAL, saturation REAL, value REAL,
  color TEXT,
  size_x REAL, size_y REAL, size_z REAL,
  fade_s REAL, fade_to REAL,       -- how the probability fades without observations; NULL = it does not
  elsewhere REAL,                  -- probability that it is elsewhere in the home if it is not at this place
  valid_from INTEGER NOT NULL,
  valid_to INTEGER,
  known_from INTEGER NOT NULL,
  known_to INTEGER,
  supersedes INTEGER REFERENCES belief,
  run INTEGER NOT NULL REFERENCES run,
  source TEXT NOT NULL
) STRICT;
CREATE INDEX belief_object ON belief (object, valid_from);
CREATE INDEX belief_scene ON belief (scene);
CREATE INDEX belief_supersedes ON belief (supersedes) WHERE supersedes IS NOT NULL;
CREATE INDEX belief_unplaced ON belief (object) WHERE x IS NULL;  -- those that have no stay

-- Where objects were believed to be, from one row of belief to the next. Derived from belief, to find objects near a
-- point or on a place at a time. Millimetres, seconds since 1970 (2147483647 = until now; later than 2038 = 2147483646),
-- place 0 = none, -5 = gone from place 5.
CREATE VIRTUAL TABLE stay USING rtree_i32(
  belief, x_from, x_to, y_from, y_to, z_from, z_to, since, until, place_from, place_to, +object);

-- What a scene shows of an object's last place, or of a place as a whole. Only objects that should have been observed
-- have a row: missed, or hidden. All others that the scene did not observe were out of view. Corrections add rows: the
-- newest one of an object in a scene holds, and out_of_view means as much as no row.
CREATE TABLE visibility (
  id INTEGER PRIMARY KEY,
  scene INTEGER NOT NULL REFERENCES scene,
  object INTEGER REFERENCES object,
  place INTEGER REFERENCES place,
  status TEXT NOT NULL CHECK (status IN ('seen', 'missed', 'hidden', 'out_of_view')),
  probability REAL CHECK (probability BETWEEN 0 AND 1),  -- object: that the status is right
  fraction REAL CHECK (fraction BETWEEN 0 AND 1),        -- place: observed part of its surface
  valid_from INTEGER NOT NULL,     -- time of the scene
  known_from INTEGER NOT NULL,
  run INTEGER NOT NULL REFERENCES run,
  CHECK ((object IS NULL) <> (place IS NULL))
) STRICT;
CREATE INDEX visibility_object ON visibility (object, valid_from) WHERE object IS NOT NULL;
CREATE INDEX visibility_place ON visibility (place, valid_from) WHERE place IS NOT NULL;
CREATE INDEX visibility_scene ON visibility (scene);

-- Facts that people or programs state about an object or a place: owner, state, alias, taxonomy, class, text, ...
CREATE TABLE fact (
  id INTEGER PRIMARY KEY,
  object INTEGER REFERENCES object,
  place INTEGER REFERENCES place,
  key TEXT NOT NULL,
  value TEXT,                      -- NULL = retracted
  probability REAL CHECK (probability BETWEEN 0 AND 1),
  valid_from INTEGER NOT NULL,
  valid_to INTEGER,
  known_from INTEGER NOT NULL,
  known_to INTEGER,
  supersedes INTEGER REFERENCES fact,
  run INTEGER NOT NULL REFERENCES run,
  source TEXT NOT NULL,
  CHECK ((object IS NULL) <> (place IS NULL))
) STRICT;
CREATE INDEX fact_key ON fact (key, value);
CREATE INDEX fact_object ON fact (object) WHERE object IS NOT NULL;
CREATE INDEX fact_supersedes ON fact (supersedes) WHERE supersedes IS NOT NULL;

-- The state from which a program resumes (the belief after the last scene, for example): only the last state of each
-- name. No answer depends on it.
CREATE TABLE checkpoint (
  name TEXT PRIMARY KEY,
  scene INTEGER REFERENCES scene,  -- after which this was the state
  encoding INTEGER NOT NULL CHECK (encoding IN (0, 1)),
  content BLOB NOT NULL
) STRICT;

-- The evidence of a scene and the decisions of the belief, in a format of memory/recorder: to explain decisions, and to
-- reason again. No other answer depends on it.
CREATE TABLE reasoning (
  scene INTEGER PRIMARY KEY REFERENCES scene,
  encoding INTEGER NOT NULL CHECK (encoding IN (0, 1)),
  content BLOB NOT NULL            -- empty = discarded by a rule of retention
) STRICT;
CREATE INDEX reasoning_scene ON reasoning (scene);  -- to count them without reading them

-- The number of rows of the large tables. Derived.
CREATE TABLE row_count (
  name TEXT PRIMARY KEY,           -- of the table
  rows INTEGER NOT NULL
) STRICT, WITHOUT ROWID;

-- A request to forget: an object, the facts about a place, or everything between two times (valid_from, valid_to).
-- Nothing else of what it named remains. The id is random; the salt keys its signatures.
CREATE TABLE forgotten (
  id INTEGER PRIMARY KEY,
  salt TEXT NOT NULL,
  valid_from INTEGER,
  valid_to INTEGER,
  known_from INTEGER NOT NULL,
  run INTEGER NOT NULL REFERENCES run,
  CHECK ((valid_from IS NULL) = (valid_to IS NULL))
) STRICT;
-- By which a merge recognises in an older copy what was forgotten: SHA-256, keyed with the salt, of the recording, frame
-- and number of an observation, or of a row of fact.
CREATE TABLE forgotten_signature (
  forgotten INTEGER NOT NULL REFERENCES forgotten,
  signature TEXT NOT NULL,
  PRIMARY KEY (forgotten, signature)
) STRICT, WITHOUT ROWID;

-- Rows of bitemporal tables are only added.
CREATE TRIGGER association_append_only BEFORE UPDATE ON association BEGIN SELECT RAISE(ABORT, 'rows are only added'); END;
CREATE TRIGGER event_append_only BEFORE UPDATE ON event BEGIN SELECT RAISE(ABORT, 'rows are only added'); END;
CREATE TRIGGER object_append_only BEFORE UPDATE ON object BEGIN SELECT RAISE(ABORT, 'rows are only added'); END;
CREATE TRIGGER belief_append_only BEFORE UPDATE ON belief BEGIN SELECT RAISE(ABORT, 'rows are only added'); END;
CREATE TRIGGER fact_append_only BEFORE UPDATE ON fact BEGIN SELECT RAISE(ABORT, 'rows are only added'); END;

-- The same rows with the effective end of their transaction time: WHERE known_to IS NULL is what is known now,
-- WHERE known_from <= T AND (known_to IS NULL OR known_to > T) is what was known at T.
CREATE VIEW association_known AS
  SELECT a.id, a.scene, a.observation, a.object, a.explanation, a.probability, a.chosen, a.valid_from, a.valid_to,
    a.known_from, coalesce(a.known_to, (SELECT min(b.known_from) FROM association b WHERE b.supersedes = a.id)) AS known_to,
    a.supersedes, a.run, a.source
  FROM association a;
CREATE VIEW event_known AS
  SELECT a.id, a.scene, a.kind, a.object, a.observation, a.place, a.from_place, a.x, a.y, a.z, a.from_x, a.from_y,
    a.from_z, a.joint, a.position, a.from_position, a.probability, a.since, a.valid_from, a.valid_to, a.known_from,
    coalesce(a.known_to, (SELECT min(b.known_from) FROM event b WHERE b.supersedes = a.id)) AS known_to,
    a.supersedes, a.run, a.source
  FROM event a;
CREATE VIEW object_known AS
  SELECT a.id, a.valid_from, a.valid_to, a.known_from,
    coalesce(a.known_to, (SELECT min(b.known_from) FROM object b WHERE b.supersedes = a.id)) AS known_to,
    a.supersedes, a.run, a.source
  FROM object a;
CREATE VIEW belief_known AS
  SELECT a.id, a.object, a.scene, a.status, a.probability, a.place, a.x, a.y, a.z, a.sigma, a.last_scene,
    a.last_observation, a.hue, a.saturation, a.value, a.color, a.size_x, a.size_y, a.size_z, a.fade_s, a.fade_to,
    a.elsewhere, a.valid_from, a.valid_to,
    a.known_from, coalesce(a.known_to, (SELECT min(b.known_from) FROM belief b WHERE b.supersedes = a.id)) AS known_to,
    a.supersedes, a.run, a.source
  FROM belief a;
CREATE VIEW fact_known AS
  SELECT a.id, a.object, a.place, a.key, a.value, a.probability, a.valid_from, a.valid_to, a.known_from,
    coalesce(a.known_to, (SELECT min(b.known_from) FROM fact b WHERE b.supersedes = a.id)) AS known_to,
    a.supersedes, a.run, a.source
  FROM fact a;

-- Public views, for sqlite3, Python, R, DuckDB. They are stable within a major version; times are ISO 8601, UTC.

-- The current belief, one row per object.
CREATE VIEW v_objects AS
  WITH latest AS (SELECT id, time FROM scene ORDER BY time DESC, id DESC LIMIT 1),
  last AS (
    SELECT b.*, (SELECT a.id FROM association_known a WHERE a.object = b.object AND a.chosen = 1
      AND a.observation IS NOT NULL AND a.probability > 0 AND a.known_to IS NULL
      ORDER BY a.valid_from DESC, a.id DESC LIMIT 1) AS association
    FROM belief_known b WHERE b.known_to IS NULL AND b.id = (SELECT c.id FROM belief_known c
      WHERE c.object = b.object AND c.known_to IS NULL ORDER BY c.valid_from DESC, c.id DESC LIMIT 1)),
  current AS (
    SELECT l.*, a.scene AS seen_scene, coalesce(a.valid_from > l.valid_from, 0) AS seen_later,
      max(l.valid_from, coalesce(a.valid_from, 0)) AS base
    FROM last l LEFT JOIN association a ON a.id = l.association)
  SELECT 'object_' || t.object AS object,
    CASE WHEN t.status = 'gone' AND NOT t.seen_later THEN 'gone'
      WHEN t.scene = latest.id AND NOT t.seen_later THEN t.status
      WHEN t.seen_scene = latest.id THEN 'seen'
      ELSE coalesce((SELECT v.status FROM visibility v WHERE v.scene = latest.id AND v.object = t.object),
        'out_of_view') END AS status,
    CASE WHEN t.seen_later THEN 1.0 ELSE t.probability END *
      CASE WHEN t.fade_s IS NULL THEN 1.0 ELSE t.fade_to + (1 - t.fade_to) *
        exp(-max(0, latest.time - t.base) / 1e9 / t.fade_s) END AS probability,
    p.name AS place, t.x, t.y, t.z, t.color, t.size_x, t.size_y, t.size_z,
    strftime('%Y-%m-%dT%H:%M:%SZ', s.time / 1000000000, 'unixepoch') AS last_seen
  FROM current t, latest LEFT JOIN place p ON p.id = t.place
    LEFT JOIN scene s ON s.id = coalesce(t.seen_scene, t.last_scene);

-- Every observation of an object by the current belief.
CREATE VIEW v_observations AS
  SELECT 'object_' || a.object AS object, strftime('%Y-%m-%dT%H:%M:%SZ', s.time / 1000000000, 'unixepoch') AS time,
    s.id AS scene, s.frame_index, p.name AS place, o.x, o.y, o.z, o.color, o.size_x, o.size_y, o.size_z,
    a.explanation, a.probability
  FROM association_known a JOIN observation o ON o.id = a.observation JOIN scene s ON s.id = a.scene
    LEFT JOIN place p ON p.id = o.place
  WHERE a.known_to IS NULL AND a.chosen = 1 AND a.object IS NOT NULL AND a.probability > 0;

-- Events by the current belief.
CREATE VIEW v_events AS
  SELECT strftime('%Y-%m-%dT%H:%M:%SZ', e.valid_from / 1000000000, 'unixepoch') AS time, e.kind,
    'object_' || e.object AS object, p.name AS place, f.name AS from_place, e.x, e.y, e.z, e.from_x, e.from_y, e.from_z,
    e.joint, e.position, e.from_position, e.probability, e.scene
  FROM event_known e LEFT JOIN place p ON p.id = e.place LEFT JOIN place f ON f.id = e.from_place
  WHERE e.known_to IS NULL AND e.probability > 0;

-- Scenes with their number of observations.
CREATE VIEW v_scenes AS
  SELECT s.id AS scene, strftime('%Y-%m-%dT%H:%M:%SZ', s.time / 1000000000, 'unixepoch') AS time,
    r.name AS recording, s.frame_index, s.x, s.y, s.z, s.qx, s.qy, s.qz, s.qw,
    (SELECT count(*) FROM observation o WHERE o.scene = s.id) AS observations
  FROM scene s LEFT JOIN recording r ON r.id = s.recording;

-- Which scene observed which place, and the part of it that it saw.
CREATE VIEW v_place_visibility AS
  SELECT p.name AS place, s.id AS scene, strftime('%Y-%m-%dT%H:%M:%SZ', s.time / 1000000000, 'unixepoch') AS time,
    v.fraction, v.status
  FROM visibility v JOIN place p ON p.id = v.place JOIN scene s ON s.id = v.scene;

-- The log of the annotators, with their times.
CREATE VIEW v_log AS
  SELECT s.id AS scene, strftime('%Y-%m-%dT%H:%M:%SZ', s.time / 1000000000, 'unixepoch') AS time, l.annotator, l.level,
    l.text, l.milliseconds
  FROM scene_log l JOIN scene s ON s.id = l.scene;

-- Facts as known now.
CREATE VIEW v_facts AS
  SELECT coalesce('object_' || f.object, p.name) AS about, f.key, f.value, f.probability, f.source
  FROM fact_known f LEFT JOIN place p ON p.id = f.place WHERE f.known_to IS NULL AND f.value IS NOT NULL;
