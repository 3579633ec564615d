-- Written by `make generate` from the migrations. Do not edit.
CREATE TABLE alembic_version (
	version_num VARCHAR(32) NOT NULL, 
	CONSTRAINT alembic_version_pkc PRIMARY KEY (version_num)
);
CREATE TABLE chunk (
	id INTEGER NOT NULL, 
	session_id INTEGER NOT NULL, 
	topic VARCHAR NOT NULL, 
	number INTEGER NOT NULL, 
	first_time FLOAT NOT NULL, 
	last_time FLOAT NOT NULL, 
	first INTEGER NOT NULL, 
	count INTEGER NOT NULL, 
	encoding VARCHAR NOT NULL, 
	data BLOB NOT NULL, run VARCHAR DEFAULT '' NOT NULL, 
	PRIMARY KEY (id), 
	CONSTRAINT chunk_place UNIQUE (session_id, topic, number), 
	FOREIGN KEY(session_id) REFERENCES session (id)
);
CREATE TABLE comm_test_cell (
	id INTEGER NOT NULL, 
	run_id INTEGER NOT NULL, 
	number INTEGER NOT NULL, 
	baud INTEGER NOT NULL, 
	arduino_delay FLOAT NOT NULL, 
	pi_delay FLOAT NOT NULL, 
	rate FLOAT NOT NULL, 
	answered BOOLEAN NOT NULL, 
	"right" INTEGER NOT NULL, 
	out_of_sequence INTEGER NOT NULL, 
	checksum_errors INTEGER NOT NULL, 
	framing_errors INTEGER NOT NULL, 
	ring_full INTEGER NOT NULL, 
	bytes_read INTEGER NOT NULL, 
	bytes_lost INTEGER NOT NULL, 
	line_errors INTEGER NOT NULL, 
	uart_overruns INTEGER NOT NULL, 
	seconds FLOAT NOT NULL, 
	causes VARCHAR NOT NULL, 
	explanation VARCHAR NOT NULL, repeated INTEGER DEFAULT '0' NOT NULL, 
	PRIMARY KEY (id), 
	CONSTRAINT comm_test_cell_place UNIQUE (run_id, number), 
	FOREIGN KEY(run_id) REFERENCES comm_test_run (id)
);
CREATE TABLE "comm_test_run" (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	name VARCHAR NOT NULL, 
	document VARCHAR NOT NULL, 
	framing VARCHAR NOT NULL, 
	direction VARCHAR NOT NULL, 
	cells INTEGER NOT NULL, 
	firmware VARCHAR NOT NULL, 
	tools VARCHAR NOT NULL, 
	host VARCHAR NOT NULL, 
	started FLOAT NOT NULL, 
	ended FLOAT, 
	state VARCHAR NOT NULL, 
	problem VARCHAR NOT NULL, 
	place VARCHAR DEFAULT 'emulated' NOT NULL, 
	sample VARCHAR DEFAULT ('') NOT NULL
);
CREATE TABLE device (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	name VARCHAR NOT NULL, 
	role VARCHAR NOT NULL, 
	kind VARCHAR NOT NULL, 
	secret VARCHAR NOT NULL, 
	paired FLOAT NOT NULL, 
	seen FLOAT NOT NULL
, limited BOOLEAN DEFAULT 0 NOT NULL, ends FLOAT, page_secret VARCHAR, session_id INTEGER);
CREATE TABLE gap (
	id INTEGER NOT NULL, 
	session_id INTEGER NOT NULL, 
	topic VARCHAR NOT NULL, 
	kind VARCHAR NOT NULL, 
	time FLOAT NOT NULL, 
	missed INTEGER NOT NULL, 
	PRIMARY KEY (id), 
	FOREIGN KEY(session_id) REFERENCES session (id)
);
CREATE TABLE "layout" (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	name VARCHAR NOT NULL, 
	saved FLOAT NOT NULL, 
	document VARCHAR NOT NULL, 
	author VARCHAR DEFAULT '' NOT NULL, 
	version INTEGER DEFAULT '1' NOT NULL, 
	CONSTRAINT layout_name UNIQUE (name)
);
CREATE TABLE "marker" (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	session_id INTEGER NOT NULL, 
	time FLOAT NOT NULL, 
	text VARCHAR NOT NULL, 
	made FLOAT NOT NULL, 
	FOREIGN KEY(session_id) REFERENCES session (id)
);
CREATE TABLE "parameter_change" (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	time FLOAT NOT NULL, 
	run VARCHAR NOT NULL, 
	who VARCHAR NOT NULL, 
	why VARCHAR NOT NULL, 
	changed VARCHAR NOT NULL, 
	undone VARCHAR NOT NULL
);
CREATE TABLE "profile" (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	name VARCHAR NOT NULL, 
	note VARCHAR NOT NULL, 
	saved FLOAT NOT NULL, 
	parameters VARCHAR NOT NULL, 
	author VARCHAR DEFAULT '' NOT NULL, 
	CONSTRAINT profile_name UNIQUE (name)
);
CREATE TABLE pulled_session (
	identifier VARCHAR NOT NULL, 
	robot VARCHAR NOT NULL, 
	pulled FLOAT NOT NULL, edits INTEGER DEFAULT '0' NOT NULL, texts VARCHAR DEFAULT '{}' NOT NULL, 
	PRIMARY KEY (identifier)
);
CREATE TABLE run_figures (
	"key" VARCHAR NOT NULL, 
	firmware VARCHAR NOT NULL, 
	software VARCHAR NOT NULL, 
	simulated FLOAT NOT NULL, 
	seconds FLOAT NOT NULL, 
	problem VARCHAR NOT NULL, 
	figures VARCHAR NOT NULL, 
	words VARCHAR NOT NULL, 
	PRIMARY KEY ("key")
);
CREATE TABLE "session" (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	name VARCHAR NOT NULL, 
	note VARCHAR NOT NULL, 
	state VARCHAR NOT NULL, 
	robot VARCHAR NOT NULL, 
	version VARCHAR NOT NULL, 
	definitions VARCHAR NOT NULL, 
	started FLOAT NOT NULL, 
	started_steady FLOAT NOT NULL, 
	ended FLOAT, 
	duration FLOAT NOT NULL, 
	samples INTEGER NOT NULL, 
	bytes INTEGER NOT NULL, 
	configuration VARCHAR NOT NULL, 
	robot_state VARCHAR NOT NULL, 
	topics VARCHAR NOT NULL, 
	identifier VARCHAR DEFAULT ('') NOT NULL, 
	boot VARCHAR DEFAULT ('') NOT NULL, 
	origin VARCHAR DEFAULT 'operator' NOT NULL, 
	scenario VARCHAR DEFAULT ('') NOT NULL, 
	scenario_name VARCHAR DEFAULT ('') NOT NULL, 
	firmware VARCHAR DEFAULT ('') NOT NULL, 
	software VARCHAR DEFAULT ('') NOT NULL, 
	seed INTEGER, 
	kept BOOLEAN DEFAULT '0' NOT NULL, 
	deleted FLOAT
, archived FLOAT, edits INTEGER DEFAULT '0' NOT NULL);
CREATE TABLE session_figures (
	session_id INTEGER NOT NULL, 
	segment INTEGER NOT NULL, 
	controller VARCHAR NOT NULL, 
	gains VARCHAR NOT NULL, 
	craft VARCHAR NOT NULL, 
	duration FLOAT, 
	deepest FLOAT, 
	rmse FLOAT, 
	cycle_amplitude FLOAT, 
	overshoot FLOAT, 
	settling_time FLOAT, 
	fin_strokes FLOAT, 
	frames_lost FLOAT, 
	alarms FLOAT, 
	PRIMARY KEY (session_id, segment), 
	FOREIGN KEY(session_id) REFERENCES session (id)
);
CREATE TABLE session_summary (
	session_id INTEGER NOT NULL, 
	document VARCHAR NOT NULL, 
	PRIMARY KEY (session_id), 
	FOREIGN KEY(session_id) REFERENCES session (id)
);
CREATE TABLE session_tag (
	id INTEGER NOT NULL, 
	session_id INTEGER NOT NULL, 
	tag VARCHAR NOT NULL, 
	PRIMARY KEY (id), 
	CONSTRAINT session_tag_place UNIQUE (session_id, tag), 
	FOREIGN KEY(session_id) REFERENCES session (id)
);
CREATE TABLE sweep (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	name VARCHAR NOT NULL, 
	title VARCHAR NOT NULL, 
	scenario VARCHAR NOT NULL, 
	text VARCHAR NOT NULL, 
	scenario_text VARCHAR NOT NULL, 
	craft VARCHAR NOT NULL, 
	who VARCHAR NOT NULL, 
	state VARCHAR NOT NULL, 
	problem VARCHAR NOT NULL, 
	runs INTEGER NOT NULL, 
	done INTEGER NOT NULL, 
	failed INTEGER NOT NULL, 
	best VARCHAR NOT NULL, 
	best_figure VARCHAR NOT NULL, 
	parameters VARCHAR NOT NULL, 
	made FLOAT NOT NULL, 
	started FLOAT, 
	ended FLOAT
);
CREATE TABLE sweep_run (
	id INTEGER NOT NULL, 
	sweep_id INTEGER NOT NULL, 
	number INTEGER NOT NULL, 
	variant INTEGER NOT NULL, 
	seed INTEGER NOT NULL, 
	parameter_values VARCHAR NOT NULL, 
	"key" VARCHAR NOT NULL, 
	PRIMARY KEY (id), 
	CONSTRAINT sweep_run_place UNIQUE (sweep_id, number), 
	FOREIGN KEY(sweep_id) REFERENCES sweep (id), 
	FOREIGN KEY("key") REFERENCES run_figures ("key")
);
CREATE TABLE tuning_run (
	id INTEGER NOT NULL PRIMARY KEY AUTOINCREMENT, 
	name VARCHAR NOT NULL, 
	kind VARCHAR NOT NULL, 
	loop VARCHAR NOT NULL, 
	started FLOAT NOT NULL, 
	state VARCHAR NOT NULL, 
	problem VARCHAR NOT NULL, 
	settings VARCHAR NOT NULL, 
	parameters VARCHAR NOT NULL, 
	figures VARCHAR NOT NULL, 
	curve BLOB NOT NULL
);
CREATE INDEX chunk_time ON chunk (session_id, topic, first_time, last_time, count);
CREATE UNIQUE INDEX device_secret ON device (secret);
CREATE INDEX ix_gap_session_id ON gap (session_id);
CREATE INDEX ix_marker_session_id ON marker (session_id);
CREATE INDEX ix_session_state ON session (state);
CREATE INDEX ix_sweep_run_key ON sweep_run ("key");
CREATE UNIQUE INDEX session_identifier ON session (identifier);
INSERT INTO alembic_version VALUES ('0018');
