-- The memories of many robots in PostgreSQL. The tables of memory/store/schema.sql are made from that file (where the
-- line "TABLES" stands below): each with the columns home and robot before its own, which begin its primary key, and
-- with the digest of each row. Derived tables and checkpoints are not kept here. Types: INTEGER is bigint, REAL double
-- precision, TEXT text in the order of its bytes, BLOB bytea.

CREATE SCHEMA loci;

-- The version of this schema and of the memories in it. The id tells databases apart.
CREATE TABLE loci.version (
  fleet integer NOT NULL,
  memory_format integer NOT NULL,         -- 1000 * major + minor
  database uuid NOT NULL DEFAULT gen_random_uuid()
);

-- One memory: that of a robot in a home.
CREATE TABLE loci.robot (
  home text COLLATE "C" NOT NULL CHECK (home <> ''),
  robot text COLLATE "C" NOT NULL CHECK (robot <> ''),
  memory text NOT NULL,                   -- when the file was made: tells memories apart
  revision bigint NOT NULL,               -- counts the pushes that changed something
  complete boolean NOT NULL,              -- false while a push of several transactions lasts, or when it was killed
  pushed timestamptz NOT NULL,
  program text NOT NULL,
  PRIMARY KEY (home, robot)
);

-- How far each table has come, committed with its rows: the last key, the number of rows, and the sum of their digests
-- modulo 2^64, by which changed and removed rows are noticed.
CREATE TABLE loci.cursor (
  home text COLLATE "C" NOT NULL,
  robot text COLLATE "C" NOT NULL,
  table_name text COLLATE "C" NOT NULL,
  key bigint[] NOT NULL,                  -- empty = no row
  rows bigint NOT NULL,
  digest bigint NOT NULL,
  PRIMARY KEY (home, robot, table_name)
);

-- Who may do what: a robot reads, adds and removes the rows of its memory; a reader (robot = '') reads all of a home.
-- The owner of the schema may do everything.
CREATE TABLE loci.member (
  role name NOT NULL,
  home text COLLATE "C" NOT NULL CHECK (home <> ''),
  robot text COLLATE "C" NOT NULL,
  PRIMARY KEY (role, home, robot)
);
ALTER TABLE loci.member ENABLE ROW LEVEL SECURITY;
CREATE POLICY own ON loci.member FOR SELECT USING (role = current_user);

-- What loci-memory unify found: objects of the unified memory of a home, kept under the name of a robot of its own, and
-- which objects of the other robots they are, by the number of observations that both have.
CREATE TABLE loci.identity (
  home text COLLATE "C" NOT NULL,
  robot text COLLATE "C" NOT NULL,        -- of the unified memory
  object bigint NOT NULL,                 -- there
  of_robot text COLLATE "C" NOT NULL,
  of_object bigint NOT NULL,
  observations bigint NOT NULL,
  found timestamptz NOT NULL,
  PRIMARY KEY (home, robot, object, of_robot, of_object)
);

CREATE FUNCTION loci.protect(protected regclass) RETURNS void LANGUAGE plpgsql AS $$
BEGIN
  EXECUTE format('ALTER TABLE %s ENABLE ROW LEVEL SECURITY', protected);
  EXECUTE format('CREATE POLICY own ON %s USING ((home, robot) IN (SELECT m.home, m.robot FROM loci.member m '
    'WHERE m.role = current_user))', protected);
  EXECUTE format('CREATE POLICY readers ON %s FOR SELECT USING (home IN (SELECT m.home FROM loci.member m '
    'WHERE m.role = current_user AND m.robot = ''''))', protected);
END $$;

-- Gives a role the rights of a robot, or of a reader (robot = '').
CREATE FUNCTION loci.admit(role text, home text, robot text) RETURNS void LANGUAGE plpgsql AS $$
BEGIN
  EXECUTE format('GRANT USAGE ON SCHEMA loci TO %I', role);
  EXECUTE format('GRANT SELECT ON ALL TABLES IN SCHEMA loci TO %I', role);
  IF robot <> '' THEN
    EXECUTE format('GRANT INSERT, DELETE ON ALL TABLES IN SCHEMA loci TO %I', role);
    EXECUTE format('GRANT UPDATE ON loci.robot, loci.cursor TO %I', role);
    EXECUTE format('REVOKE INSERT, DELETE ON loci.version, loci.member FROM %I', role);
  END IF;
  INSERT INTO loci.member VALUES (admit.role::name, admit.home, admit.robot) ON CONFLICT DO NOTHING;
END $$;

-- Takes these rights back. False = it had none.
CREATE FUNCTION loci.dismiss(role text, home text, robot text) RETURNS boolean LANGUAGE plpgsql AS $$
DECLARE
  found_any boolean;
BEGIN
  DELETE FROM loci.member m
    WHERE m.role = dismiss.role::name AND m.home = dismiss.home AND m.robot = dismiss.robot;
  found_any := FOUND;
  IF NOT EXISTS (SELECT 1 FROM loci.member m WHERE m.role = dismiss.role::name AND m.robot <> '') THEN
    EXECUTE format('REVOKE INSERT, UPDATE, DELETE ON ALL TABLES IN SCHEMA loci FROM %I', role);
  END IF;
  IF NOT EXISTS (SELECT 1 FROM loci.member m WHERE m.role = dismiss.role::name) THEN
    EXECUTE format('REVOKE SELECT ON ALL TABLES IN SCHEMA loci FROM %I', role);
    EXECUTE format('REVOKE USAGE ON SCHEMA loci FROM %I', role);
  END IF;
  RETURN found_any;
END $$;
REVOKE EXECUTE ON FUNCTION loci.protect, loci.admit, loci.dismiss FROM PUBLIC;

-- TABLES

SELECT loci.protect('loci.robot');
SELECT loci.protect('loci.cursor');
SELECT loci.protect('loci.identity');

-- What questions in SQL look for.
CREATE INDEX scene_time ON loci.scene (home, robot, time);
CREATE INDEX observation_scene ON loci.observation (home, robot, scene);
CREATE INDEX association_object ON loci.association (home, robot, object, valid_from)
  WHERE chosen = 1 AND observation IS NOT NULL AND probability > 0;
CREATE INDEX association_supersedes ON loci.association (home, robot, supersedes) WHERE supersedes IS NOT NULL;
CREATE INDEX event_time ON loci.event (home, robot, valid_from);
CREATE INDEX event_supersedes ON loci.event (home, robot, supersedes) WHERE supersedes IS NOT NULL;
CREATE INDEX belief_object ON loci.belief (home, robot, object, valid_from);
CREATE INDEX belief_supersedes ON loci.belief (home, robot, supersedes) WHERE supersedes IS NOT NULL;
CREATE INDEX fact_supersedes ON loci.fact (home, robot, supersedes) WHERE supersedes IS NOT NULL;
CREATE INDEX visibility_scene ON loci.visibility (home, robot, scene);

-- The public views of a memory file, with home and robot. They show what their reader may read.

CREATE FUNCTION loci.time_text(nanoseconds bigint) RETURNS text LANGUAGE sql IMMUTABLE AS
  $$ SELECT to_char(to_timestamp(nanoseconds / 1000000000) AT TIME ZONE 'UTC', 'YYYY-MM-DD"T"HH24:MI:SS"Z"') $$;

-- Rows that are known now.
CREATE VIEW loci.association_now WITH (security_invoker = true) AS
  SELECT a.* FROM loci.association a WHERE a.known_to IS NULL AND NOT EXISTS (
    SELECT 1 FROM loci.association b WHERE b.home = a.home AND b.robot = a.robot AND b.supersedes = a.id);
CREATE VIEW loci.event_now WITH (security_invoker = true) AS
  SELECT a.* FROM loci.event a WHERE a.known_to IS NULL AND NOT EXISTS (
    SELECT 1 FROM loci.event b WHERE b.home = a.home AND b.robot = a.robot AND b.supersedes = a.id);
CREATE VIEW loci.belief_now WITH (security_invoker = true) AS
  SELECT a.* FROM loci.belief a WHERE a.known_to IS NULL AND NOT EXISTS (
    SELECT 1 FROM loci.belief b WHERE b.home = a.home AND b.robot = a.robot AND b.supersedes = a.id);
CREATE VIEW loci.fact_now WITH (security_invoker = true) AS
  SELECT a.* FROM loci.fact a WHERE a.known_to IS NULL AND NOT EXISTS (
    SELECT 1 FROM loci.fact b WHERE b.home = a.home AND b.robot = a.robot AND b.supersedes = a.id);

-- The current belief, one row per object.
CREATE VIEW loci.v_objects WITH (security_invoker = true) AS
  WITH latest AS (
    SELECT DISTINCT ON (home, robot) home, robot, id, time FROM loci.scene ORDER BY home, robot, time DESC, id DESC),
  last AS (
    SELECT DISTINCT ON (home, robot, object) * FROM loci.belief_now
    ORDER BY home, robot, object, valid_from DESC, id DESC),
  seen AS (
    SELECT DISTINCT ON (home, robot, object) home, robot, object, scene, valid_from FROM loci.association_now
    WHERE chosen = 1 AND observation IS NOT NULL AND probability > 0 AND object IS NOT NULL
    ORDER BY home, robot, object, valid_from DESC, id DESC),
  current AS (
    SELECT l.*, a.scene AS seen_scene, coalesce(a.valid_from > l.valid_from, false) AS seen_later,
      greatest(l.valid_from, coalesce(a.valid_from, 0)) AS base
    FROM last l LEFT JOIN seen a USING (home, robot, object))
  SELECT t.home, t.robot, 'object_' || t.object AS object,
    CASE WHEN t.status = 'gone' AND NOT t.seen_later THEN 'gone'
      WHEN t.scene = latest.id AND NOT t.seen_later THEN t.status
      WHEN t.seen_scene = latest.id THEN 'seen'
      ELSE coalesce((SELECT v.status FROM loci.visibility v WHERE v.home = t.home AND v.robot = t.robot
        AND v.scene = latest.id AND v.object = t.object ORDER BY v.id LIMIT 1), 'out_of_view') END AS status,
    CASE WHEN t.seen_later THEN 1.0 ELSE t.probability END *
      CASE WHEN t.fade_s IS NULL OR latest.time <= t.base THEN 1.0 ELSE t.fade_to + (1 - t.fade_to) *
        exp(greatest(-700, -(latest.time - t.base) / 1e9::double precision / greatest(t.fade_s, 1e-9))) END AS probability,
    p.name AS place, t.x, t.y, t.z, t.color, t.size_x, t.size_y, t.size_z, loci.time_text(s.time) AS last_seen
  FROM current t JOIN latest USING (home, robot)
    LEFT JOIN loci.place p ON p.home = t.home AND p.robot = t.robot AND p.id = t.place
    LEFT JOIN loci.scene s ON s.home = t.home AND s.robot = t.robot AND s.id = coalesce(t.seen_scene, t.last_scene);

-- Every observation of an object by the current belief.
CREATE VIEW loci.v_observations WITH (security_invoker = true) AS
  SELECT a.home, a.robot, 'object_' || a.object AS object, loci.time_text(s.time) AS time, s.id AS scene,
    s.frame_index, p.name AS place, o.x, o.y, o.z, o.color, o.size_x, o.size_y, o.size_z, a.explanation, a.probability
  FROM loci.association_now a
    JOIN loci.observation o ON o.home = a.home AND o.robot = a.robot AND o.id = a.observation
    JOIN loci.scene s ON s.home = a.home AND s.robot = a.robot AND s.id = a.scene
    LEFT JOIN loci.place p ON p.home = a.home AND p.robot = a.robot AND p.id = o.place
  WHERE a.chosen = 1 AND a.object IS NOT NULL AND a.probability > 0;

-- Events by the current belief.
CREATE VIEW loci.v_events WITH (security_invoker = true) AS
  SELECT e.home, e.robot, loci.time_text(e.valid_from) AS time, e.kind, 'object_' || e.object AS object,
    p.name AS place, f.name AS from_place, e.x, e.y, e.z, e.from_x, e.from_y, e.from_z, e.joint, e.position,
    e.from_position, e.probability, e.scene
  FROM loci.event_now e
    LEFT JOIN loci.place p ON p.home = e.home AND p.robot = e.robot AND p.id = e.place
    LEFT JOIN loci.place f ON f.home = e.home AND f.robot = e.robot AND f.id = e.from_place
  WHERE e.probability > 0;

-- Scenes with their number of observations.
CREATE VIEW loci.v_scenes WITH (security_invoker = true) AS
  SELECT s.home, s.robot, s.id AS scene, loci.time_text(s.time) AS time, r.name AS recording, s.frame_index, s.x, s.y,
    s.z, s.qx, s.qy, s.qz, s.qw, (SELECT count(*) FROM loci.observation o
      WHERE o.home = s.home AND o.robot = s.robot AND o.scene = s.id) AS observations
  FROM loci.scene s LEFT JOIN loci.recording r ON r.home = s.home AND r.robot = s.robot AND r.id = s.recording;

-- Which scene observed which place, and the part of it that it saw.
CREATE VIEW loci.v_place_visibility WITH (security_invoker = true) AS
  SELECT v.home, v.robot, p.name AS place, s.id AS scene, loci.time_text(s.time) AS time, v.fraction, v.status
  FROM loci.visibility v JOIN loci.place p ON p.home = v.home AND p.robot = v.robot AND p.id = v.place
    JOIN loci.scene s ON s.home = v.home AND s.robot = v.robot AND s.id = v.scene;

-- The log of the annotators, with their times.
CREATE VIEW loci.v_log WITH (security_invoker = true) AS
  SELECT l.home, l.robot, s.id AS scene, loci.time_text(s.time) AS time, l.annotator, l.level, l.text, l.milliseconds
  FROM loci.scene_log l JOIN loci.scene s ON s.home = l.home AND s.robot = l.robot AND s.id = l.scene;

-- Facts as known now.
CREATE VIEW loci.v_facts WITH (security_invoker = true) AS
  SELECT f.home, f.robot, coalesce('object_' || f.object, p.name) AS about, f.key, f.value, f.probability, f.source
  FROM loci.fact_now f LEFT JOIN loci.place p ON p.home = f.home AND p.robot = f.robot AND p.id = f.place
  WHERE f.value IS NOT NULL;
