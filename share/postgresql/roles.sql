-- SPDX-FileCopyrightText: 2026 The Engram authors
-- SPDX-License-Identifier: BSD-3-Clause
--
-- The roles of a fleet, for a database of maps: psql -d fleet -f roles.sql, as its owner. Then give each robot and person a
-- login of their own: CREATE ROLE anna LOGIN IN ROLE engram_robot.
CREATE ROLE engram_reader NOLOGIN;
CREATE ROLE engram_robot NOLOGIN;
CREATE ROLE engram_keeper NOLOGIN;
SELECT format('GRANT CREATE ON DATABASE %I TO engram_keeper', current_database()) \gexec
