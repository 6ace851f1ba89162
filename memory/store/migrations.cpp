#include "memory/store/schema.h"

namespace loci::memory {

const char* const kMigrationTo1001 = R"sql(
DROP VIEW v_objects;
DROP VIEW belief_known;
ALTER TABLE annotation RENAME TO annotation_1000;
DROP INDEX annotation_scene;
DROP INDEX annotation_value;
CREATE TABLE term (
  id INTEGER PRIMARY KEY,
  type TEXT NOT NULL,              -- type name: "loci.Shape", "loci.Text", ...
  value TEXT NOT NULL,
  UNIQUE (value, type)
) STRICT;
CREATE INDEX term_word ON term (value COLLATE NOCASE);
CREATE VIRTUAL TABLE term_text USING fts5(value, content='term', content_rowid='id');
CREATE TRIGGER term_is_searched AFTER INSERT ON term BEGIN
  INSERT INTO term_text (rowid, value) VALUES (new.id, new.value);
END;
CREATE TRIGGER term_is_forgotten AFTER DELETE ON term BEGIN
  INSERT INTO term_text (term_text, rowid, value) VALUES ('delete', old.id, old.value);
END;

CREATE TABLE annotation (
  id INTEGER PRIMARY KEY,
  scene INTEGER NOT NULL REFERENCES scene,
  observation INTEGER REFERENCES observation,  -- NULL = about the scene
  term INTEGER NOT NULL REFERENCES term,
  confidence REAL,                 -- uncalibrated
  feature_structure INTEGER REFERENCES feature_structure
) STRICT;
CREATE INDEX annotation_scene ON annotation (scene, observation);
CREATE VIEW annotation_said AS
  SELECT a.id, a.scene, a.observation, t.type, t.value, a.confidence, a.feature_structure
  FROM annotation a JOIN term t ON t.id = a.term;

-- What the belief was told about a scene and what it made of it, in a form of loci's own (memory/recorder): to explain
-- decisions, and to reason anew. No other answer depends on it.
CREATE TABLE reasoning (
  scene INTEGER PRIMARY KEY REFERENCES scene,
  encoding INTEGER NOT NULL CHECK (encoding IN (0, 1)),
  content BLOB NOT NULL
) STRICT;

INSERT INTO reasoning (scene, encoding, content)
  SELECT a.scene, b.encoding, b.content FROM annotation_1000 a JOIN blob b ON b.hash = a.value
  WHERE a.type = 'loci.memory.SceneReasoning';
DELETE FROM annotation_1000 WHERE type = 'loci.memory.SceneReasoning';
DELETE FROM blob WHERE media = 'application/x-loci-reasoning';
INSERT INTO term (type, value) SELECT type, value FROM annotation_1000 GROUP BY value, type ORDER BY min(id);
INSERT INTO annotation (id, scene, observation, term, confidence, feature_structure)
  SELECT a.id, a.scene, a.observation, t.id, a.confidence, a.feature_structure
  FROM annotation_1000 a JOIN term t ON t.value = a.value AND t.type = a.type;
DROP TABLE annotation_1000;
DROP INDEX association_object;
CREATE INDEX association_sighting ON association (object, valid_from, scene)
  WHERE chosen = 1 AND observation IS NOT NULL AND probability > 0;
CREATE TABLE object_term (
  term INTEGER NOT NULL REFERENCES term,
  object INTEGER NOT NULL REFERENCES object,
  PRIMARY KEY (term, object)
) STRICT, WITHOUT ROWID;

INSERT OR IGNORE INTO object_term (term, object)
  SELECT n.term, a.object FROM association a JOIN annotation n ON n.scene = a.scene AND n.observation = a.observation
  WHERE a.chosen = 1 AND a.probability > 0 AND a.object IS NOT NULL;
-- What was forgotten on request: an object, or everything of a time. Nothing else is left of it.
CREATE TABLE forgotten (
  id INTEGER PRIMARY KEY,
  object INTEGER REFERENCES object,
  valid_from INTEGER, valid_to INTEGER,
  known_from INTEGER NOT NULL,
  run INTEGER NOT NULL REFERENCES run,
  CHECK ((object IS NULL) <> (valid_from IS NULL))
) STRICT;

ALTER TABLE belief ADD COLUMN fade_s REAL;
ALTER TABLE belief ADD COLUMN fade_to REAL;
CREATE VIEW belief_known AS
  SELECT a.id, a.object, a.scene, a.status, a.probability, a.place, a.x, a.y, a.z, a.sigma, a.last_scene,
    a.last_observation, a.hue, a.saturation, a.value, a.color, a.size_x, a.size_y, a.size_z, a.fade_s, a.fade_to,
    a.valid_from, a.valid_to,
    a.known_from, coalesce(a.known_to, (SELECT min(b.known_from) FROM belief b WHERE b.supersedes = a.id)) AS known_to,
    a.supersedes, a.run, a.source
  FROM belief a;
CREATE VIRTUAL TABLE stay USING rtree_i32(
  belief, x_from, x_to, y_from, y_to, z_from, z_to, since, until, place_from, place_to, +object);

INSERT INTO stay
  SELECT id, round(1000 * x), round(1000 * x), round(1000 * y), round(1000 * y), round(1000 * z), round(1000 * z),
    valid_from / 1000000000, coalesce(lead(valid_from) OVER (PARTITION BY object ORDER BY valid_from, id)
    / 1000000000, 2147483647), coalesce(place, 0), coalesce(place, 0), object FROM belief WHERE x IS NOT NULL;
DELETE FROM visibility WHERE object IS NOT NULL AND status IN ('seen', 'out_of_view');
-- What is believed now, one row per object.
CREATE VIEW v_objects AS
  WITH latest AS (SELECT id, time FROM scene ORDER BY time DESC, id DESC LIMIT 1),
  last AS (
    SELECT b.*, (SELECT a.id FROM association_known a WHERE a.object = b.object AND a.chosen = 1
      AND a.observation IS NOT NULL AND a.probability > 0 AND a.known_to IS NULL
      ORDER BY a.valid_from DESC, a.id DESC LIMIT 1) AS sighting
    FROM belief_known b WHERE b.known_to IS NULL AND b.id = (SELECT c.id FROM belief_known c
      WHERE c.object = b.object AND c.known_to IS NULL ORDER BY c.valid_from DESC, c.id DESC LIMIT 1)),
  told AS (
    SELECT l.*, a.scene AS seen_scene, coalesce(a.valid_from > l.valid_from, 0) AS seen_later,
      max(l.valid_from, coalesce(a.valid_from, 0)) AS base
    FROM last l LEFT JOIN association a ON a.id = l.sighting)
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
  FROM told t, latest LEFT JOIN place p ON p.id = t.place
    LEFT JOIN scene s ON s.id = coalesce(t.seen_scene, t.last_scene);

)sql";

const char* const kMigrationTo1002 = R"sql(
DROP TABLE object_term;
CREATE TABLE object_term (
  term INTEGER NOT NULL REFERENCES term,
  object INTEGER NOT NULL REFERENCES object,
  since INTEGER NOT NULL,          -- of the first sighting that was called so
  PRIMARY KEY (term, object)
) STRICT, WITHOUT ROWID;
CREATE TABLE sighting_mark (
  object INTEGER NOT NULL REFERENCES object,
  number INTEGER NOT NULL,         -- of the sighting, in order of time
  valid_from INTEGER NOT NULL,
  scene INTEGER NOT NULL REFERENCES scene,
  PRIMARY KEY (object, number)
) STRICT, WITHOUT ROWID;
)sql";

const char* const kMigrationTo1003 = R"sql(
CREATE TABLE scene_mark (
  number INTEGER PRIMARY KEY,      -- of the scene, in order of time
  time INTEGER NOT NULL,
  scene INTEGER NOT NULL REFERENCES scene
) STRICT;
CREATE TABLE visit (
  object INTEGER NOT NULL REFERENCES object,
  valid_from INTEGER NOT NULL,     -- of the first sighting there
  scene INTEGER NOT NULL REFERENCES scene,
  place INTEGER NOT NULL,          -- 0 = none
  PRIMARY KEY (object, valid_from, scene)
) STRICT, WITHOUT ROWID;
CREATE INDEX visit_place ON visit (object, place, valid_from, scene);
DROP VIEW v_looks;
DROP VIEW v_objects;
ALTER TABLE visibility RENAME TO visibility_1002;
DROP INDEX visibility_object;
DROP INDEX visibility_place;
DROP INDEX visibility_scene;
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
INSERT INTO visibility (id, scene, object, place, status, probability, fraction, valid_from, known_from, run)
  SELECT v.id, v.scene, v.object, v.place, v.status, v.probability, v.fraction, s.time, v.known_from, v.run
  FROM visibility_1002 v JOIN scene s ON s.id = v.scene ORDER BY v.id;
DROP TABLE visibility_1002;
CREATE INDEX visibility_object ON visibility (object, valid_from) WHERE object IS NOT NULL;
CREATE INDEX visibility_place ON visibility (place, valid_from) WHERE place IS NOT NULL;
CREATE INDEX visibility_scene ON visibility (scene);
-- What is believed now, one row per object.
CREATE VIEW v_objects AS
  WITH latest AS (SELECT id, time FROM scene ORDER BY time DESC, id DESC LIMIT 1),
  last AS (
    SELECT b.*, (SELECT a.id FROM association_known a WHERE a.object = b.object AND a.chosen = 1
      AND a.observation IS NOT NULL AND a.probability > 0 AND a.known_to IS NULL
      ORDER BY a.valid_from DESC, a.id DESC LIMIT 1) AS sighting
    FROM belief_known b WHERE b.known_to IS NULL AND b.id = (SELECT c.id FROM belief_known c
      WHERE c.object = b.object AND c.known_to IS NULL ORDER BY c.valid_from DESC, c.id DESC LIMIT 1)),
  told AS (
    SELECT l.*, a.scene AS seen_scene, coalesce(a.valid_from > l.valid_from, 0) AS seen_later,
      max(l.valid_from, coalesce(a.valid_from, 0)) AS base
    FROM last l LEFT JOIN association a ON a.id = l.sighting)
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
  FROM told t, latest LEFT JOIN place p ON p.id = t.place
    LEFT JOIN scene s ON s.id = coalesce(t.seen_scene, t.last_scene);
-- Which scene looked at which place, and how much of it was seen.
CREATE VIEW v_looks AS
  SELECT p.name AS place, s.id AS scene, strftime('%Y-%m-%dT%H:%M:%SZ', s.time / 1000000000, 'unixepoch') AS time,
    v.fraction, v.status
  FROM visibility v JOIN place p ON p.id = v.place JOIN scene s ON s.id = v.scene;
)sql";

const char* const kDerivation = R"sql(
DELETE FROM scene_mark;
INSERT INTO scene_mark (number, time, scene)
  SELECT number, time, id FROM (SELECT id, time, row_number() OVER (ORDER BY time, id) AS number FROM scene)
  WHERE number % 64 = 1;
DELETE FROM visit;
INSERT INTO visit (object, place, valid_from, scene)
  SELECT object, place, valid_from, scene FROM (
    SELECT a.object, coalesce(o.place, 0) AS place, a.valid_from, a.scene, lag(coalesce(o.place, 0))
      OVER (PARTITION BY a.object ORDER BY a.valid_from, a.scene) AS place_before
    FROM association a JOIN observation o ON o.id = a.observation
    WHERE a.chosen = 1 AND a.probability > 0 AND a.object IS NOT NULL)
  WHERE place_before IS NOT place;
DELETE FROM object_term;
INSERT INTO object_term (term, object, since)
  SELECT n.term, a.object, min(a.valid_from)
  FROM association a JOIN annotation n ON n.scene = a.scene AND n.observation = a.observation
  WHERE a.chosen = 1 AND a.probability > 0 AND a.object IS NOT NULL GROUP BY n.term, a.object;
DELETE FROM sighting_mark;
INSERT INTO sighting_mark (object, number, valid_from, scene)
  SELECT object, number, valid_from, scene FROM (
    SELECT object, valid_from, scene, row_number() OVER (PARTITION BY object ORDER BY valid_from, scene) AS number
    FROM association WHERE chosen = 1 AND observation IS NOT NULL AND probability > 0 AND object IS NOT NULL)
  WHERE number % 64 = 1;
DELETE FROM stay;
INSERT INTO stay
  SELECT id, mm_x, mm_x, mm_y, mm_y, mm_z, mm_z, valid_from / 1000000000, until, side * place, side * place, object
  FROM (SELECT id, object, coalesce(place, 0) AS place, iif(status = 'gone', -1, 1) AS side, valid_from,
      round(min(max(1000 * x, -2e9), 2e9)) AS mm_x, round(min(max(1000 * y, -2e9), 2e9)) AS mm_y,
      round(min(max(1000 * z, -2e9), 2e9)) AS mm_z,
      coalesce(lead(valid_from) OVER (PARTITION BY object ORDER BY valid_from, id) / 1000000000, 2147483647) AS until
    FROM belief)
  WHERE mm_x IS NOT NULL AND mm_y IS NOT NULL AND mm_z IS NOT NULL;
INSERT INTO term_text (term_text) VALUES ('rebuild');
)sql";

const char* const kMigrationTo1004 = R"sql(
CREATE INDEX scene_mark_time ON scene_mark (time);
CREATE INDEX reasoning_scene ON reasoning (scene);
)sql";

const char* const kMigrationTo1005 = R"sql(
ALTER TABLE scene ADD COLUMN kinds INTEGER REFERENCES blob;
ALTER TABLE observation ADD COLUMN cloud INTEGER REFERENCES blob;
CREATE TABLE scene_log (
  scene INTEGER NOT NULL REFERENCES scene,
  number INTEGER NOT NULL,         -- of the line, from 0
  annotator TEXT NOT NULL,
  level TEXT NOT NULL,             -- debug, info, warning, error
  text TEXT,                       -- NULL = nothing but that it is done
  milliseconds REAL,               -- that it took; NULL = not measured
  PRIMARY KEY (scene, number)
) STRICT, WITHOUT ROWID;
CREATE TABLE row_count (
  name TEXT PRIMARY KEY,           -- of the table
  rows INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
CREATE VIEW v_log AS
  SELECT s.id AS scene, strftime('%Y-%m-%dT%H:%M:%SZ', s.time / 1000000000, 'unixepoch') AS time, l.annotator, l.level,
    l.text, l.milliseconds
  FROM scene_log l JOIN scene s ON s.id = l.scene;
)sql";

const char* const kCounting = R"sql(
DELETE FROM row_count;
INSERT INTO row_count (name, rows)
  SELECT 'scene', count(*) FROM scene UNION ALL SELECT 'observation', count(*) FROM observation
  UNION ALL SELECT 'annotation', count(*) FROM annotation UNION ALL SELECT 'blob', count(*) FROM blob
  UNION ALL SELECT 'feature_structure', count(*) FROM feature_structure
  UNION ALL SELECT 'association', count(*) FROM association UNION ALL SELECT 'event', count(*) FROM event
  UNION ALL SELECT 'belief', count(*) FROM belief UNION ALL SELECT 'visibility', count(*) FROM visibility
  UNION ALL SELECT 'scene_log', count(*) FROM scene_log UNION ALL SELECT 'reasoning', count(*) FROM reasoning
  UNION ALL SELECT 'stay', count(*) FROM stay;
)sql";

const char* const kDropUnusedBlobs = R"sql(
DELETE FROM blob WHERE id NOT IN (
  SELECT urdf FROM map UNION SELECT sidecar FROM map WHERE sidecar IS NOT NULL
  UNION SELECT depth FROM scene WHERE depth IS NOT NULL UNION SELECT image FROM scene WHERE image IS NOT NULL
  UNION SELECT kinds FROM scene WHERE kinds IS NOT NULL
  UNION SELECT crop FROM observation WHERE crop IS NOT NULL UNION SELECT mask FROM observation WHERE mask IS NOT NULL
  UNION SELECT cloud FROM observation WHERE cloud IS NOT NULL
  UNION SELECT content FROM type_system UNION SELECT blob FROM feature_structure_blob);
)sql";

const char* const kViewsOf1000 = R"sql(
CREATE TEMP VIEW annotation_said AS
  SELECT id, scene, observation, type, value, confidence, feature_structure FROM annotation
  WHERE type <> 'loci.memory.SceneReasoning';
CREATE TEMP VIEW reasoning AS
  SELECT a.scene, b.encoding, b.content FROM main.annotation a JOIN main.blob b ON b.hash = a.value
  WHERE a.type = 'loci.memory.SceneReasoning';
CREATE TEMP VIEW belief_known AS SELECT *, NULL AS fade_s, NULL AS fade_to FROM main.belief_known;
)sql";

const char* const kViewsOf1002 = R"sql(
CREATE TEMP VIEW visibility AS
  SELECT v.*, s.time AS valid_from FROM main.visibility v JOIN main.scene s ON s.id = v.scene;
)sql";

const char* const kViewsOf1004 = R"sql(
CREATE TEMP VIEW scene AS SELECT *, NULL AS kinds FROM main.scene;
CREATE TEMP VIEW observation AS SELECT *, NULL AS cloud FROM main.observation;
CREATE TEMP VIEW scene_log AS
  SELECT NULL AS scene, NULL AS number, NULL AS annotator, NULL AS level, NULL AS text, NULL AS milliseconds WHERE 0;
CREATE TEMP VIEW row_count AS SELECT NULL AS name, NULL AS rows WHERE 0;
)sql";

}  // namespace loci::memory
