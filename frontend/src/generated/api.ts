// Written by `make generate` from the OpenAPI document of the server. Do not edit.

export interface paths {
    "/api/access/codes": {
        post: operations["makeCode"];
    };
    "/api/access/confirm": {
        post: operations["confirmBrowser"];
    };
    "/api/access/devices": {
        get: operations["listDevices"];
    };
    "/api/access/devices/{device}": {
        delete: operations["revokeDevice"];
        patch: operations["changeDevice"];
    };
    "/api/access/me": {
        get: operations["getMe"];
    };
    "/api/access/pair": {
        post: operations["pairBrowser"];
    };
    "/api/access/read": {
        post: operations["openReadingLink"];
    };
    "/api/access/reading-links": {
        get: operations["listReadingLinks"];
        post: operations["makeReadingLink"];
    };
    "/api/access/reading-links/{link}": {
        delete: operations["endReadingLink"];
    };
    "/api/access/sign-out": {
        post: operations["signOut"];
    };
    "/api/access/tokens": {
        post: operations["makeToken"];
    };
    "/api/alive": {
        get: operations["checkAlive"];
    };
    "/api/audit": {
        get: operations["listAudit"];
    };
    "/api/audit/csv": {
        get: operations["exportAudit"];
    };
    "/api/backup": {
        get: operations["downloadBackup"];
    };
    "/api/bring-up": {
        get: operations["getBringUp"];
        post: operations["beginBringUp"];
        delete: operations["endBringUp"];
    };
    "/api/bring-up/actions": {
        post: operations["actInBringUp"];
    };
    "/api/bring-up/hands": {
        post: operations["useHandsInBringUp"];
    };
    "/api/bring-up/report": {
        get: operations["getBringUpReport"];
    };
    "/api/comm-tests/cancel": {
        post: operations["cancelTestRun"];
    };
    "/api/comm-tests/check": {
        post: operations["checkTestDocument"];
    };
    "/api/comm-tests/documents": {
        get: operations["listTestDocuments"];
    };
    "/api/comm-tests/runs": {
        get: operations["listTestRuns"];
        post: operations["startTestRun"];
    };
    "/api/comm-tests/runs/{run}": {
        get: operations["getTestRun"];
    };
    "/api/comm-tests/runs/{run}/csv": {
        get: operations["downloadTestRunCsv"];
    };
    "/api/comm-tests/runs/{run}/json": {
        get: operations["downloadTestRunJson"];
    };
    "/api/comm-tests/tables": {
        get: operations["listTestTables"];
    };
    "/api/compare": {
        post: operations["compareSessions"];
    };
    "/api/compare/lines": {
        post: operations["compareLines"];
    };
    "/api/compare/report": {
        get: operations["getComparisonReport"];
    };
    "/api/control": {
        get: operations["getControl"];
    };
    "/api/control/release": {
        post: operations["releaseControl"];
    };
    "/api/control/take": {
        post: operations["takeControl"];
    };
    "/api/doctor": {
        get: operations["getFindings"];
        post: operations["examineAgain"];
    };
    "/api/doors": {
        get: operations["listDoors"];
    };
    "/api/exports": {
        get: operations["listExports"];
        post: operations["startExport"];
    };
    "/api/exports/{export}": {
        get: operations["getExport"];
        delete: operations["deleteExport"];
    };
    "/api/exports/{export}/file": {
        get: operations["downloadExport"];
    };
    "/api/figures": {
        get: operations["getFigureStudy"];
    };
    "/api/film": {
        get: operations["getFilmPlan"];
        put: operations["chooseFilm"];
    };
    "/api/firmware": {
        get: operations["getFirmwareUpload"];
        post: operations["uploadFirmware"];
    };
    "/api/health": {
        get: operations["getHealth"];
    };
    "/api/identification": {
        get: operations["getIdentification"];
        post: operations["startIdentification"];
    };
    "/api/identification/adopt": {
        post: operations["adoptCraft"];
    };
    "/api/identification/cancel": {
        post: operations["cancelIdentification"];
    };
    "/api/identification/undo": {
        post: operations["undoCraft"];
    };
    "/api/imports": {
        post: operations["importSession"];
    };
    "/api/lab": {
        get: operations["getLab"];
        delete: operations["leaveLab"];
    };
    "/api/lab/join": {
        post: operations["joinLab"];
    };
    "/api/lab/pulls": {
        get: operations["listPulls"];
    };
    "/api/layouts": {
        get: operations["listLayouts"];
        post: operations["saveLayout"];
    };
    "/api/layouts/{layout}": {
        get: operations["getLayout"];
        delete: operations["deleteLayout"];
    };
    "/api/link/frames": {
        get: operations["getLinkFrames"];
    };
    "/api/missions": {
        get: operations["listMissions"];
        post: operations["keepMission"];
    };
    "/api/missions/check": {
        post: operations["checkMission"];
    };
    "/api/missions/nodes": {
        get: operations["listMissionNodes"];
    };
    "/api/missions/runs/{name}": {
        get: operations["listMissionRuns"];
    };
    "/api/missions/start": {
        post: operations["startMission"];
    };
    "/api/missions/state": {
        get: operations["getMissionState"];
    };
    "/api/missions/trial": {
        get: operations["getMissionTrial"];
        post: operations["startMissionTrial"];
    };
    "/api/missions/trial/cancel": {
        post: operations["cancelMissionTrial"];
    };
    "/api/missions/versions/{name}": {
        get: operations["listMissionVersions"];
    };
    "/api/missions/{name}": {
        delete: operations["deleteMission"];
    };
    "/api/panels": {
        get: operations["listPanels"];
    };
    "/api/panels/frame": {
        get: operations["getPanelFrame"];
    };
    "/api/panels/own/{panel}": {
        get: operations["getPanel"];
    };
    "/api/parameters": {
        get: operations["getParameters"];
    };
    "/api/parameters/changes": {
        get: operations["listParameterChanges"];
    };
    "/api/parameters/undo": {
        post: operations["undoParameters"];
    };
    "/api/past": {
        get: operations["getPast"];
    };
    "/api/profiles": {
        get: operations["listProfiles"];
        post: operations["saveProfile"];
    };
    "/api/profiles/file": {
        post: operations["importProfile"];
    };
    "/api/profiles/{profile}": {
        delete: operations["deleteProfile"];
    };
    "/api/profiles/{profile}/file": {
        get: operations["downloadProfile"];
    };
    "/api/profiles/{profile}/restore": {
        post: operations["restoreProfile"];
    };
    "/api/robot": {
        get: operations["getRobot"];
    };
    "/api/robot/commands/acknowledge": {
        post: operations["commandAcknowledge"];
    };
    "/api/robot/commands/arm": {
        post: operations["commandArm"];
    };
    "/api/robot/commands/calibrate": {
        post: operations["commandCalibrate"];
    };
    "/api/robot/commands/card": {
        post: operations["commandCard"];
    };
    "/api/robot/commands/check_fins": {
        post: operations["commandCheckFins"];
    };
    "/api/robot/commands/loop": {
        post: operations["commandLoop"];
    };
    "/api/robot/commands/measure_gyro": {
        post: operations["commandMeasureGyro"];
    };
    "/api/robot/commands/mission_end": {
        post: operations["commandMissionEnd"];
    };
    "/api/robot/commands/mission_pause": {
        post: operations["commandMissionPause"];
    };
    "/api/robot/commands/mission_skip": {
        post: operations["commandMissionSkip"];
    };
    "/api/robot/commands/mode": {
        post: operations["commandMode"];
    };
    "/api/robot/commands/parameters": {
        post: operations["commandParameters"];
    };
    "/api/robot/commands/steering": {
        post: operations["commandSteering"];
    };
    "/api/robot/commands/vision_settings": {
        post: operations["commandVisionSettings"];
    };
    "/api/robot/commands/zero_depth": {
        post: operations["commandZeroDepth"];
    };
    "/api/robot/stop": {
        post: operations["stopRobot"];
    };
    "/api/robots": {
        get: operations["listRobots"];
    };
    "/api/robots/codes": {
        post: operations["makeJoiningCode"];
    };
    "/api/robots/join": {
        post: operations["joinRobot"];
    };
    "/api/robots/stop": {
        post: operations["stopAllRobots"];
    };
    "/api/robots/{robot}": {
        delete: operations["removeRobot"];
    };
    "/api/scenarios": {
        get: operations["listScenarios"];
        post: operations["keepScenario"];
    };
    "/api/scenarios/cancel": {
        post: operations["cancelScenario"];
    };
    "/api/scenarios/check": {
        post: operations["checkScenario"];
    };
    "/api/scenarios/events": {
        get: operations["listScenarioEvents"];
    };
    "/api/scenarios/runs": {
        post: operations["startScenario"];
    };
    "/api/scenarios/state": {
        get: operations["getScenarioState"];
    };
    "/api/scene/view": {
        put: operations["putView"];
    };
    "/api/sessions": {
        get: operations["listSessions"];
        post: operations["startSession"];
    };
    "/api/sessions/archived": {
        post: operations["noteArchived"];
    };
    "/api/sessions/controllers": {
        get: operations["listSessionControllers"];
    };
    "/api/sessions/edits": {
        get: operations["listSessionEdits"];
    };
    "/api/sessions/groups": {
        get: operations["listSessionGroups"];
    };
    "/api/sessions/robots": {
        get: operations["listSessionRobots"];
    };
    "/api/sessions/{session}": {
        get: operations["getSession"];
        delete: operations["deleteSession"];
        patch: operations["changeSession"];
    };
    "/api/sessions/{session}/blocks": {
        get: operations["getBlocks"];
    };
    "/api/sessions/{session}/film": {
        get: operations["getFilm"];
    };
    "/api/sessions/{session}/film/part": {
        get: operations["getFilmPart"];
    };
    "/api/sessions/{session}/markers": {
        post: operations["addMark"];
    };
    "/api/sessions/{session}/markers/{mark}": {
        delete: operations["removeMark"];
        patch: operations["changeMark"];
    };
    "/api/sessions/{session}/missions": {
        get: operations["listSessionMissions"];
    };
    "/api/sessions/{session}/pair": {
        get: operations["getPair"];
    };
    "/api/sessions/{session}/purge": {
        post: operations["purgeSession"];
    };
    "/api/sessions/{session}/readings": {
        get: operations["getReadings"];
    };
    "/api/sessions/{session}/restore": {
        post: operations["restoreSession"];
    };
    "/api/sessions/{session}/signals": {
        get: operations["listSignals"];
    };
    "/api/sessions/{session}/snapshot": {
        get: operations["getSnapshot"];
    };
    "/api/sessions/{session}/snapshots": {
        get: operations["listSessionSnapshots"];
    };
    "/api/sessions/{session}/spectrum": {
        get: operations["getSpectrum"];
    };
    "/api/sessions/{session}/stop": {
        post: operations["stopSession"];
    };
    "/api/sessions/{session}/story": {
        get: operations["getStory"];
    };
    "/api/sessions/{session}/story/figures": {
        get: operations["getStoryFigures"];
    };
    "/api/sessions/{session}/thumbnail": {
        get: operations["getThumbnail"];
    };
    "/api/sessions/{session}/timeline": {
        get: operations["getTimeline"];
    };
    "/api/sessions/{session}/track": {
        get: operations["getTrack"];
    };
    "/api/simulator": {
        put: operations["putSimulator"];
    };
    "/api/snapshots": {
        post: operations["takeSnapshot"];
    };
    "/api/storage": {
        get: operations["getStorage"];
    };
    "/api/sweeps": {
        get: operations["listSweeps"];
        post: operations["startSweep"];
    };
    "/api/sweeps/check": {
        post: operations["checkSweep"];
    };
    "/api/sweeps/template": {
        get: operations["getSweepTemplate"];
    };
    "/api/sweeps/{sweep}": {
        get: operations["getSweep"];
        delete: operations["deleteSweep"];
    };
    "/api/sweeps/{sweep}/cancel": {
        post: operations["cancelSweep"];
    };
    "/api/sweeps/{sweep}/profile": {
        post: operations["saveSweepProfile"];
    };
    "/api/sweeps/{sweep}/resume": {
        post: operations["resumeSweep"];
    };
    "/api/sweeps/{sweep}/runs": {
        get: operations["listSweepRuns"];
    };
    "/api/sweeps/{sweep}/runs/{run}/session": {
        post: operations["recordSweepRun"];
    };
    "/api/sweeps/{sweep}/table": {
        get: operations["downloadSweepTable"];
    };
    "/api/tags": {
        get: operations["listTags"];
    };
    "/api/topics": {
        get: operations["listTopics"];
    };
    "/api/tuning/prediction": {
        post: operations["predictStep"];
    };
    "/api/tuning/runs": {
        get: operations["listTuningRuns"];
        post: operations["startTuningRun"];
    };
    "/api/tuning/runs/{run}": {
        get: operations["getTuningRun"];
        delete: operations["deleteTuningRun"];
        patch: operations["renameTuningRun"];
    };
    "/api/tuning/state": {
        get: operations["getTuningState"];
    };
    "/api/tuning/stop": {
        post: operations["stopTuningRun"];
    };
    "/api/update": {
        get: operations["getUpdate"];
        post: operations["beginUpdate"];
    };
    "/api/update/release": {
        post: operations["sendRelease"];
    };
    "/api/vision": {
        get: operations["getVision"];
        put: operations["editVision"];
    };
    "/api/vision/pick": {
        post: operations["pickColour"];
    };
    "/api/vision/read": {
        post: operations["readVision"];
    };
    "/api/vision/toml": {
        get: operations["downloadVision"];
    };
}
export interface components {
    schemas: {
        /** @description Acknowledges all alarms. After a failsafe the robot may be armed again from then on. */
        AcknowledgeCommand: Record<string, never>;
        /** @description A fit that runs. */
        ActiveIdentification: {
            left_out: number | null;
            /** @description 0 to 1 */
            progress: number;
            /** @description 16 hexadecimal digits, never used again */
            run: string;
            sessions: number[];
        };
        /** @description The active run; times in s of the scenario. */
        ActiveRun: {
            /** @enum {string} */
            board: "host" | "emulated";
            duration: number;
            elapsed: number;
            events: components["schemas"]["ScenarioEvent"][];
            name: string;
            next: components["schemas"]["ScenarioEvent"] | null;
            /** @enum {string} */
            phase: "waiting" | "preparing" | "running" | "ending";
            /** @enum {string} */
            place: "live" | "simulated";
            /** @description 16 hexadecimal digits, never used again */
            run: string;
            session: number | null;
            title: string;
        };
        /** @description The active run. */
        ActiveTuning: {
            /** @description s, steady clock */
            began: number;
            cycles: number;
            /** @enum {string} */
            kind: "step" | "relay";
            /** @enum {string} */
            loop: "depth" | "heading" | "pitch" | "roll";
            /** @enum {string} */
            phase: "settling" | "balancing" | "running" | "complete" | "stopped" | "failed";
            progress: number;
            run: number;
            settings: {
                [key: string]: unknown;
            };
            /** @description s, steady clock, when its phase began */
            since: number;
        };
        /** @description The craft in force. */
        AdoptedCraft: {
            /** @description whether the craft before the last adoption can be restored */
            can_undo: boolean;
            /** @description its file; empty for the default craft */
            file: string;
            origin: string;
            /** @description why no craft can be adopted now; empty if one can */
            problem: string;
            /** @description empty for the default craft */
            title: string;
        };
        /** @description A fault that is active, or not acknowledged yet. */
        Alarm: {
            acknowledged: boolean;
            active: boolean;
            cause: string;
            consequences: string[];
            fault: string;
            remedy: string;
            /** @enum {string} */
            severity: "info" | "caution" | "alarm";
            since: number;
            until: number | null;
            what: string;
        };
        /** @description The moment that becomes 0 s in every session. */
        Align: {
            /**
             * @default start
             * @enum {string}
             */
            by: "start" | "armed" | "set_point" | "marker" | "mission" | "segment";
            /**
             * @description its name; the first match counts
             * @default
             */
            marker: string;
            /**
             * @description number of the set-point step
             * @default 1
             */
            number: number;
            /**
             * @description of the mission, as “3.1.2”
             * @default
             */
            step: string;
        };
        /** @description Sessions that a lab has, by their identifiers. */
        ArchivedSessions: {
            identifiers: string[];
        };
        /** @description Arms the robot. It is refused with all reasons against arming. */
        ArmCommand: {
            /** @description s for which it may go on without the server */
            alone?: number;
            /**
             * @description who steers: controller or pilot
             * @enum {string}
             */
            mode?: "automatic" | "manual";
            /** @description s for which it may go on while nobody watches; 0: without an end; null: `[control] unwatched` */
            unwatched?: number | null;
        };
        /**
         * @description One act. `time` in s since 1970; `who`, `role` and `address` are empty where nobody was signed in or
         *     no network was used. `device` is the number of the browser or program, 0 the shell, None nobody.
         *
         *     `count` is more than 1 where so many of the same kind follow one another too fast to be listed.
         */
        AuditEntry: {
            about: string;
            action: string;
            address: string;
            /** @default 1 */
            count: number;
            device: number | null;
            /** @enum {string} */
            outcome: "done" | "refused" | "failed" | "begun";
            role: string;
            time: number;
            who: string;
        };
        /** @description Entries, newest first; `more`: older matching entries exist. */
        AuditList: {
            entries: components["schemas"]["AuditEntry"][];
            more: boolean;
        };
        /** @description The levels of the detectors' pins. */
        BeaconLevels: {
            left: boolean;
            right: boolean;
        };
        /** @description The emulated robot on its workbench, as seen by the person at it. */
        BenchHands: {
            barometer_hpa: number;
            /** @description of its pressure sensor in a bucket */
            depth_cm: number;
            /** @description ° from along the mount to the tip down, as they are */
            fins: number[];
            /**
             * @description the detector that has a lamp before it
             * @enum {string}
             */
            lamp: "none" | "right" | "left";
            /** @description the ends of its leak sensor are in water */
            leak: boolean;
            /** @description at the battery's plug */
            multimeter_volts: number;
            /** @enum {string} */
            pose: "level" | "nose_up" | "right_down";
        };
        /** @description A moment of a session, with a note if somebody wrote one. */
        Bookmark: {
            id: number;
            /**
             * Format: date-time
             * @description UTC
             */
            made: string;
            /** @description the note's first line, for lists and flags */
            name: string;
            /** @description the note, in Markdown; empty without one */
            text: string;
            /** @description s since the session's start */
            time: number;
        };
        /** @description Changes of a bookmark; null leaves a field unchanged. */
        BookmarkChanges: {
            /** @description the note when the editing began: refused if somebody else has changed it since. null replaces any */
            base?: string | null;
            text?: string | null;
            time?: number | null;
        };
        /** @description A button of a step. A button to hold is posted every 100 ms while held, and with `stop` at the end. */
        BringUpAction: {
            inputs: components["schemas"]["BringUpQuestion"][];
            /** @enum {string} */
            kind: "press" | "hold";
            label: string;
            name: string;
        };
        /** @description An action of a step, with the person's answers. */
        BringUpOrder: {
            /** @description an action of this step, or skip */
            action: string;
            inputs?: {
                [key: string]: number | string;
            };
            /** @description the bring-up that is meant; null: any */
            run?: string | null;
            step: string;
        };
        /** @description A number that a person gives, or one of the choices. */
        BringUpQuestion: {
            /** @description empty for a number */
            choices: string[];
            label: string;
            maximum: number;
            minimum: number;
            name: string;
            optional: boolean;
            unit: string;
        };
        /** @description One check of one part. */
        BringUpResult: {
            /** @description what to do where it is not good */
            advice: string;
            expected: string;
            measured: string;
            /** @enum {string} */
            verdict: "good" | "note" | "wrong";
            what: string;
        };
        /** @description The bring-up as a whole. */
        BringUpState: {
            /** @description null on a real board, and before the board is ready */
            hands: components["schemas"]["BenchHands"] | null;
            /** @enum {string} */
            phase: "idle" | "starting" | "ready" | "ending";
            /** @description why it could not go on; empty if it could */
            problem: string;
            raw: components["schemas"]["RawReadings"] | null;
            /** @description address of the newest report */
            report: string | null;
            /** @description 16 hexadecimal digits, never used again; empty before the first one */
            run: string;
            steps: components["schemas"]["BringUpStep"][];
            /** @description what it is doing, or how it ended */
            words: string;
        };
        /** @description A step: its task and its results. */
        BringUpStep: {
            about: string;
            actions: components["schemas"]["BringUpAction"][];
            expected: string;
            name: string;
            results: components["schemas"]["BringUpResult"][];
            /**
             * @description skipped: left out by a person, and not measured since
             * @enum {string}
             */
            state: "open" | "done" | "wrong" | "skipped";
            title: string;
        };
        /** @description Stores a calibration in the board. It is refused while the robot is armed. */
        CalibrateCommand: {
            values: components["schemas"]["CalibrationValues"];
        };
        /** @description A robot's calibration as its board keeps it. Fins: front right, back right, back left, front left. */
        CalibrationValues: {
            /** @description the IMU chip's axes that point forward, right, down; -: away from it */
            axes: [
                "x" | "-x" | "y" | "-y" | "z" | "-z",
                "x" | "-x" | "y" | "-y" | "z" | "-z",
                "x" | "-x" | "y" | "-y" | "z" | "-z"
            ];
            /** @description the battery's true voltage over the measured one */
            battery_factor: number;
            /** @description whether a detector's pin is low while it sees the beacon */
            beacons_inverted: boolean;
            /** @description the steps that are done */
            done: ("fins" | "motors" | "axes" | "gyro" | "pressure" | "battery" | "beacons")[];
            /** @description whether the counts fall as the fin's tip goes down */
            encoders_reversed: [
                boolean,
                boolean,
                boolean,
                boolean
            ];
            /** @description encoder counts, 1024 a turn, where each fin points along its mount */
            fin_zeros: [
                number,
                number,
                number,
                number
            ];
            /** @description rad/s, measured at rest; forward, right, down */
            gyro_bias: [
                number,
                number,
                number
            ];
            /** @description whether the counts fall at positive drive */
            motors_reversed: [
                boolean,
                boolean,
                boolean,
                boolean
            ];
            /** @description Pa that the sensor shows too much */
            pressure_offset: number;
        };
        /** @description The caller, and the robot; `pairing_open` is true while a pairing code is valid. */
        CallerDetails: {
            /** @description why the sign-in that was shown counts no longer; else empty */
            ended: string;
            /** @description end of the caller's token or reading link, s since 1970 */
            ends: number | null;
            identity: components["schemas"]["Identity"] | null;
            /** @description true where this server is a lab's, which has no robot */
            lab: boolean;
            /** @description names of the operations that the caller's role may not call; a reader's are all that do not read the session of the link */
            operators_only: string[];
            pairing_open: boolean;
            robot: string;
            signed_in: boolean;
        };
        /** @description Holds a card before the simulated camera, or takes it away. */
        CardCommand: {
            /** @description the card's; null: no card */
            colour?: string | null;
        };
        /** @description One cell; delays and `seconds` (the test's time) in s, the counts of both ends together. */
        Cell: {
            answered: boolean;
            arduino_delay: number;
            baud: number;
            bytes_lost: number;
            bytes_read: number;
            causes: string[];
            checksum_errors: number;
            framing_errors: number;
            line_errors: number;
            number: number;
            out_of_sequence: number;
            pi_delay: number;
            /** @description share of the numbers that arrived right */
            rate: number;
            /** @description of the rate, each begins with its cause */
            reasons: string[];
            repeated: number;
            right: number;
            ring_full: number;
            seconds: number;
            uart_overruns: number;
        };
        /** @description Parameters that were changed together. */
        Change: {
            id: number;
            /**
             * Format: date-time
             * @description UTC
             */
            time: string;
            /** @description true for the next change that can be undone */
            undoable: boolean;
            /** @description the person who undid it; empty if it was not undone */
            undone: string;
            values: components["schemas"]["ChangedValue"][];
            who: string;
            /** @description “Profile NAME” for a restored profile, else empty */
            why: string;
        };
        /** @description One parameter before and after a change. */
        ChangedValue: {
            after: boolean | number | string;
            before: boolean | number | string;
            name: string;
        };
        /** @description A document's problems, field by field, or its tests. */
        Check: {
            problems: components["schemas"]["EntryProblem"][];
            tests: components["schemas"]["CheckedTest"][];
        };
        /** @description Arms for some seconds and moves each fin. An event says which fins followed; then it disarms. */
        CheckFinsCommand: Record<string, never>;
        /** @description The check on the session that was left out. */
        CheckedSession: {
            after_error: number;
            /** @description share of the measured signals' own variation, before the fit */
            before_error: number;
            channels: components["schemas"]["PredictedChannel"][];
            id: number;
            /** @description error before over error after */
            improvement: number;
            name: string;
            /** @description s since the session's start */
            times: number[];
        };
        /** @description A runnable test of a document; `seconds` is its cells' estimated duration in the test's time. */
        CheckedTest: {
            /** @description s */
            arduino_delays: number[];
            /** @description bit/s */
            bauds: number[];
            cells: number;
            /** @enum {string} */
            direction: "to_board" | "to_host" | "both";
            framing: string;
            id: number;
            name: string;
            /** @description s */
            pi_delays: number[];
            seconds: number;
        };
        /**
         * @description The range of one colour: lowest and highest hue, saturation and value, both included.
         *
         *     A hue range whose first number is above its second runs through 0, where red lies. Raises ValueError
         *     where another one does.
         */
        "ColourRange-Input": {
            hue: [
                number,
                number
            ];
            saturation: [
                number,
                number
            ];
            value: [
                number,
                number
            ];
        };
        /**
         * @description The range of one colour: lowest and highest hue, saturation and value, both included.
         *
         *     A hue range whose first number is above its second runs through 0, where red lies. Raises ValueError
         *     where another one does.
         */
        "ColourRange-Output": {
            hue: [
                number,
                number
            ];
            saturation: [
                number,
                number
            ];
            value: [
                number,
                number
            ];
        };
        /** @description A run with its configuration and its cells. */
        CommTestRunDetails: {
            /** @description number in the document */
            cells: number;
            cells_done: number;
            /** @enum {string} */
            direction: "to_board" | "to_host" | "both";
            document: {
                [key: string]: unknown;
            };
            /** @description UTC; null while it runs */
            ended: string | null;
            /** @description hash of the sketch, the core and the compiler's flags */
            firmware: string;
            framing: string;
            host: string;
            id: number;
            name: string;
            /** @enum {string} */
            place: "emulated" | "robot";
            problem: string;
            /** @description null without cells */
            rate_mean: number | null;
            rate_min: number | null;
            results: components["schemas"]["Cell"][];
            sample: string;
            /**
             * Format: date-time
             * @description UTC
             */
            started: string;
            /** @enum {string} */
            state: "running" | "complete" | "cancelled" | "failed" | "interrupted";
            tools: {
                [key: string]: string;
            };
        };
        /** @description A document to run, and its place. */
        CommTestStart: {
            /** @enum {string} */
            place: "emulated" | "robot";
            text: string;
        };
        /** @description One session of a comparison. */
        Compared: {
            /** @description from and to, s since its start */
            armed: [
                number,
                number
            ][];
            /** @description s */
            duration: number;
            events: components["schemas"]["Moment"][];
            /** @description by name; empty if none were asked for */
            figures: {
                [key: string]: components["schemas"]["Figure"];
            };
            id: number;
            markers: components["schemas"]["Moment"][];
            /** @description the steps of its missions that began, each once, in the order of the document */
            mission_steps: components["schemas"]["MissionStepStart"][];
            name: string;
            /** @description the moment that is 0 s, s since its start; null if it lacks that */
            offset: number | null;
            /** @description why it cannot be aligned; empty if it can */
            problem: string;
            /** @description range of the figures */
            range: [
                number,
                number
            ][];
            /** @description the chosen one, from 1 on; null without any */
            segment: number | null;
            /** @description in order of time, the first 200 */
            segments: components["schemas"]["Segment"][];
            /** @description by signal; missing signals are left out */
            series: {
                [key: string]: components["schemas"]["SignalLine"];
            };
            /** @description number of changes of the set point while armed */
            set_point_steps: number;
            /** @description UTC, s since 1970 */
            started: number;
            state: string;
        };
        /** @description A comparison of sessions, in the requested order. */
        Comparison: {
            align: components["schemas"]["Align"];
            differences: components["schemas"]["Difference"][];
            figures: components["schemas"]["FigureMeaning"][];
            /** @description of what the figures cover */
            likeness: components["schemas"]["Likeness"];
            sessions: components["schemas"]["Compared"][];
            /** @description the requested ones that at least one session has */
            signals: components["schemas"]["Signal"][];
        };
        /** @description A comparison: lines, and the range of the figures. */
        ComparisonQuery: {
            align?: components["schemas"]["Align"];
            band?: number | null;
            /** @description false: none, and the answer comes sooner */
            figures?: boolean;
            /**
             * @description what the figures cover where `range` is null
             * @enum {string}
             */
            over?: "armed" | "segment";
            /** @description columns of each line */
            points?: number;
            /** @description for the figures */
            range?: components["schemas"]["TimeRange"] | null;
            /** @description at most one of each session; of the others the one most alike */
            segments?: components["schemas"]["SegmentChoice"][];
            sessions: number[];
            signals: string[];
            /** @description the drawn time range; all of it if null */
            view?: components["schemas"]["TimeRange"] | null;
        };
        /** @description A code that confirms the user of this browser. */
        Confirmation: {
            code: string;
        };
        /** @description The holder of control, and the counts of stick commands. */
        ControlDetails: {
            driven: components["schemas"]["DriveCounts"];
            /** @description grows with every change of the holder */
            epoch: number;
            holder: components["schemas"]["Holder"] | null;
        };
        /** @description The holder of control, as on the live socket. */
        ControlState: {
            /** @description grows with every change of the holder */
            epoch: number;
            holder: components["schemas"]["Holder"] | null;
        };
        /** @description A controller that can be chosen, and its gains as they stand. */
        ControllerChoice: {
            gains: components["schemas"]["Gain"][];
            name: string;
            title: string;
        };
        /** @description The controller in force, with its gains. */
        ControllerInForce: {
            controller: string;
            gains: {
                [key: string]: number;
            };
            title: string;
        };
        /** @description The answer to an adoption, or to its undoing. */
        CraftChange: {
            affected: string[];
        };
        /** @description Changes of a device; null leaves a field unchanged. */
        DeviceChanges: {
            name?: string | null;
            role?: ("viewer" | "operator") | null;
        };
        /** @description A paired browser or program; times in s since 1970. */
        DeviceDetails: {
            /** @description why the token, or an unused sign-in, counts no longer; else empty */
            ended: string;
            /** @description end of a token; null where it never ends */
            ends: number | null;
            id: number;
            /** @enum {string} */
            kind: "browser" | "program" | "lab" | "reader" | "shell";
            /** @description true for a token that may not administer, in any role */
            limited: boolean;
            name: string;
            paired: number;
            /** @enum {string} */
            role: "viewer" | "operator";
            seen: number;
            /** @description true for the caller itself */
            you: boolean;
        };
        /** @description A property that differs between sessions. */
        Difference: {
            /** @description In force, Parameters, Session, Craft, robot.toml or Scenario */
            group: string;
            name: string;
            /** @description one for each session; empty if it lacks the property */
            values: string[];
        };
        /**
         * @description The parts of one frame. Where `problem` is not empty, the frame was discarded and the rest is a guess.
         *
         *     `time` (s, steady clock) is when it was handed to the line or taken from it; `sent` means to the board.
         *     `bytes` is the frame on the line with its closing zero, in hexadecimal; `kinds` names its messages.
         *     A `reliable` frame is repeated until it is acknowledged; an `open` one belongs to no session. `number` is
         *     its own, of 16 reliable or 4096 unreliable ones, and `acknowledged` the reliable frame that its sender
         *     waits for; both are null where the frame is too damaged to have any.
         */
        Dissection: {
            acknowledged: number | null;
            bytes: string;
            kinds: string[];
            number: number | null;
            open: boolean;
            problem: string;
            reliable: boolean;
            sent: boolean;
            time: number;
        };
        /** @description The text of a test document. */
        DocumentText: {
            text: string;
        };
        /** @description A program that is connected. */
        DoorClientDetails: {
            address: string;
            in_control: boolean;
            /** @description of its token */
            name: string;
            /** @description messages and calls of a ROS 2 program that were refused */
            refused: number;
            /** @enum {string} */
            role: "viewer" | "operator";
            /** @description messages so far */
            sent: number;
            /** @description s, steady clock */
            since: number;
            /** @description that it subscribes to */
            topics: string[];
        };
        /** @description A door for other programs. */
        DoorDetails: {
            clients: components["schemas"]["DoorClientDetails"][];
            /** @enum {string} */
            name: "rosbridge" | "foxglove" | "ros2";
            /** @description `[doors]` in robot.toml says so */
            open: boolean;
            /** @description below the server's address; for ROS 2 the endpoint of Zenoh */
            path: string;
        };
        /** @description Stick commands since the server started: passed to the robot, and dropped for a reason. */
        DriveCounts: {
            /**
             * @description more than 0.3 s ahead of the robot's clock
             * @default 0
             */
            from_the_future: number;
            /**
             * @description from a client without control
             * @default 0
             */
            not_in_control: number;
            /**
             * @description not after the last one that was passed on
             * @default 0
             */
            not_newer: number;
            /**
             * @description of an earlier change of control
             * @default 0
             */
            other_lease: number;
            /** @default 0 */
            passed: number;
            /**
             * @description more than 0.3 s old when it came
             * @default 0
             */
            too_old: number;
        };
        /** @description An encoder's angle and the field of its magnet. */
        EncoderReading: {
            /** @description 0 to 1023 */
            counts: number;
            /** @enum {string} */
            field: "green" | "yellow" | "red" | "silent";
        };
        /** @description The last fit. */
        EndedIdentification: {
            left_out: number | null;
            /** @description why it has no result; empty if it has one */
            problem: string;
            result: components["schemas"]["IdentificationResult"] | null;
            /** @description 16 hexadecimal digits, never used again */
            run: string;
            sessions: number[];
        };
        /** @description The run that ended last; `session` is null if it recorded nothing. */
        EndedRun: {
            /** @description the newest older session of the same scenario */
            before: number | null;
            name: string;
            /** @enum {string} */
            place: "live" | "simulated";
            problem: string;
            /** @description 16 hexadecimal digits, never used again */
            run: string;
            session: number | null;
            /** @enum {string} */
            state: "complete" | "cancelled" | "failed";
            title: string;
        };
        /**
         * @description A reason why an entry cannot be used; `text` names the entry, `words` is the text without its name.
         *
         *     `path` leads to the entry from the document: keys, and indices from 0. It is empty where the problem is
         *     the whole document's.
         */
        EntryProblem: {
            path: (string | number)[];
            text: string;
            words: string;
        };
        /** @description The position by dead reckoning since the robot was armed, m: an estimate whose error grows. */
        EstimatedPosition: {
            /** @description standard deviation */
            deviation_x: number;
            /** @description standard deviation */
            deviation_y: number;
            /** @description along heading 0 */
            x: number;
            /** @description along heading 90° */
            y: number;
        };
        /** @description A field of an event; a `value` is a list or a table, written as TOML. */
        EventField: {
            /** @description of a choice; empty otherwise */
            choices: string[];
            /** @enum {string} */
            kind: "number" | "whole" | "text" | "switch" | "choice" | "value";
            maximum: number | null;
            meaning: string;
            minimum: number | null;
            name: string;
            required: boolean;
        };
        /** @description Choice of a session's topics, range and file format. */
        ExportOptions: {
            /** @description such as depth.depth or motor.angle_0; null for all. For csv-grid alone */
            columns: string[] | null;
            /**
             * @description of the chunks of mcap; zstd and lz4 need their packages
             * @default none
             * @enum {string}
             */
            compression: "none" | "zstd" | "lz4";
            /** @description s since the session's start; null for its end */
            end: number | null;
            /** @enum {string} */
            format: "csv" | "csv-grid" | "xlsx" | "parquet" | "mcap" | "archive" | "report" | "mp4";
            /**
             * @description values over the film of mp4: as subtitles, which a player shows or hides, or as the flight view's lines, drawn into each picture
             * @default none
             * @enum {string}
             */
            overlay: "none" | "subtitles" | "lines";
            /**
             * @description s between the lines of csv-grid
             * @default 0.1
             */
            period: number;
            /**
             * @description none: CSV for programs; point, comma: for a spreadsheet with this decimal sign, with a byte order mark, and for comma with semicolons. For csv and csv-grid
             * @default none
             * @enum {string}
             */
            spreadsheet: "none" | "point" | "comma";
            /** @description s since the session's start; null for its beginning */
            start: number | null;
            /** @description names of topics; null for all. Not for csv-grid, archive and report */
            topics: string[] | null;
        };
        /** @description A reason for failed runs, and how many have it. */
        FailureCount: {
            count: number;
            reason: string;
        };
        /** @description A figure's value, or the reason for its lack. */
        Figure: {
            mark: components["schemas"]["FigureMark"] | null;
            value: number | null;
            /**
             * @description the reason for a missing value, or a remark
             * @default
             */
            words: string;
        };
        /** @description A session with a remarkable value. */
        FigureExample: {
            name: string;
            /** @description 0: the whole session */
            segment: number;
            session: number;
            value: number;
        };
        /** @description The values of one group: their number, and shares of them that are less. */
        FigureGroup: {
            /** @description values in each of the bins */
            bins: number[];
            count: number;
            greatest: number;
            /** @description a quarter of the values is more */
            high: number;
            least: number;
            /** @description a quarter of the values is less */
            low: number;
            median: number;
            /** @description empty: not known */
            name: string;
        };
        /** @description The mean of a figure over the seeds, with its 95 % interval; null with one seed. */
        FigureInterval: {
            count: number;
            high: number | null;
            low: number | null;
            mean: number;
        };
        /** @description The position of a figure in its chart: s since the session's start or the step, and m or degrees. */
        FigureMark: {
            end: number;
            high: number | null;
            /** @description null: as high as the chart */
            low: number | null;
            start: number;
        };
        /** @description Name, unit and definition of a figure. */
        FigureMeaning: {
            /**
             * @description the better value: the least, the nearest to 0
             * @enum {string}
             */
            better: "less" | "zero" | "neither";
            decimals: number;
            /** @description its definition in a sentence */
            meaning: string;
            name: string;
            title: string;
            unit: string;
        };
        /** @description The values of the sessions of one period. */
        FigurePeriod: {
            count: number;
            high: number;
            low: number;
            median: number;
            /**
             * Format: date-time
             * @description UTC
             */
            start: string;
        };
        /** @description One figure of many sessions. */
        FigureStudy: {
            /** @description values */
            count: number;
            course: components["schemas"]["FigurePeriod"][];
            /** @description of the bins, from the least value on; empty without values */
            edges: number[];
            /** @description sessions of the greatest values */
            greatest: components["schemas"]["FigureExample"][];
            groups: components["schemas"]["FigureGroup"][];
            /** @description sessions of the least values */
            least: components["schemas"]["FigureExample"][];
            meaning: components["schemas"]["FigureMeaning"];
            /** @enum {string} */
            period: "day" | "week" | "month" | "year";
            /** @description sessions that match */
            sessions: number;
            /** @description of these, those whose figures are still to be computed */
            waiting: number;
        };
        /** @description The film of a session: its times, the number of its pictures, and their coding. */
        FilmDescription: {
            /** @description of its parts as browsers name it, such as "avc1.42c016" */
            codec: string;
            pictures: number;
            spans: components["schemas"]["FilmSpan"][];
        };
        /** @description The choice of a film: for the session that records, and those to come. */
        FilmOrder: {
            /** @enum {string} */
            quality: "low" | "medium" | "high";
            /** @description pictures a second; at most the stream's */
            rate: number;
            /** @description true: sessions are filmed */
            record: boolean;
        };
        /** @description The choice of a film that is in force, and the space that films need. */
        FilmPlan: {
            /** @enum {string} */
            coding: "h264" | "jpeg";
            /** @description true where the bytes are those of this robot's films */
            measured: boolean;
            picture_bytes: components["schemas"]["PictureBytes"];
            /** @enum {string} */
            quality: "low" | "medium" | "high";
            /** @description pictures a second */
            rate: number;
            /** @description pictures a second of the camera's stream */
            rate_max: number;
            record: boolean;
            /** @description the reason for which nothing is filmed, whatever is chosen; or empty */
            refusal: string;
            /** @description bytes of the disk that are free for recordings, above `keep_free` */
            room: number;
        };
        /** @description A time without a gap, s since the session's start. */
        FilmSpan: {
            end: number;
            start: number;
        };
        /** @description One fin: angles in rad, and the drive. */
        FinReading: {
            angle: number;
            drive: number;
            set_angle: number;
        };
        /** @description A fin that is turned by hand. */
        FinTurn: {
            fin: number;
            /**
             * @description along its mount, or its tip down
             * @enum {string}
             */
            to: "along" | "down";
        };
        /** @description The outcome of one check: a sentence, and the command or act that solves the problem. */
        Finding: {
            /** @default  */
            mend: string;
            name: string;
            text: string;
            title: string;
            /** @enum {string} */
            verdict: "ok" | "look" | "wrong";
        };
        /** @description A session of a fit. */
        FittedSession: {
            id: number;
            name: string;
            /** @description of its IMU: turn rate (rad/s), then specific force (m/s²); null without a window */
            offsets: number[] | null;
            /** @description number of windows of 8 s that could be used */
            windows: number;
        };
        /** @description Something that happened at a moment of a dive. */
        Flag: {
            /** @enum {string} */
            kind: "event" | "alarm" | "card" | "bookmark" | "controller" | "gains" | "set_point" | "mission";
            /** @enum {string} */
            severity: "info" | "caution" | "alarm";
            text: string;
            /** @description s since the session's start */
            time: number;
        };
        /** @description One number of a controller that may be tuned. */
        Gain: {
            maximum: number;
            meaning: string;
            minimum: number;
            name: string;
            unit: string;
            value: number;
        };
        /** @description An act of hands at the emulated robot; fields that are null leave their part unchanged. */
        HandsOrder: {
            depth_cm?: number | null;
            lamp?: ("none" | "right" | "left") | null;
            /** @description put the ends of the leak sensor into water, or dry them */
            leak?: boolean | null;
            /** @description make wiring and parts as the wiring table says */
            mend?: boolean;
            pose?: ("level" | "nose_up" | "right_down") | null;
            turn?: components["schemas"]["FinTurn"] | null;
        };
        /** @description The health of all parts: "failed" if one has failed, else "starting" if one starts, else "ok". */
        Health: {
            /** @description server and database; of a robot also runtime, link, board, simulator, scene, camera, and events where `[events]` in robot.toml names a broker; of a lab also router and robots */
            parts: components["schemas"]["PartHealth"][];
            robot: string;
            /** @enum {string} */
            status: "ok" | "starting" | "failed";
            version: string;
        };
        /** @description The client in control. */
        Holder: {
            client: number;
            name: string;
        };
        /** @description The result of a fit. */
        IdentificationResult: {
            /** @description what changes if the craft is adopted, in words */
            affected: string[];
            check: components["schemas"]["CheckedSession"] | null;
            /** @description the craft file */
            craft: string;
            /** @description the motions that these sessions do not show, in words */
            missing: string[];
            /** @description σ by sensor: pressure (Pa), gyroscope, accelerometer */
            noise: {
                [key: string]: number;
            };
            numbers: components["schemas"]["IdentifiedNumber"][];
            sessions: components["schemas"]["FittedSession"][];
        };
        /** @description The sessions of a fit, and the one that checks it. */
        IdentificationStart: {
            /** @description the session that checks the prediction; null: none */
            left_out?: number | null;
            sessions: number[];
        };
        /** @description The fit that was started. */
        IdentificationStarted: {
            /** @description 16 hexadecimal digits, never used again */
            run: string;
        };
        /** @description The running fit, the last one, and the craft in force. */
        IdentificationState: {
            active: components["schemas"]["ActiveIdentification"] | null;
            craft: components["schemas"]["AdoptedCraft"];
            last: components["schemas"]["EndedIdentification"] | null;
        };
        /** @description A number of the craft before and after a fit. */
        IdentifiedNumber: {
            before: number;
            /** @description standard deviation; null if the sessions do not show it */
            deviation: number | null;
            name: string;
            /** @enum {string} */
            seen: "well" | "weakly" | "no";
            title: string;
            unit: string;
            value: number;
            /** @description the confidence, or the motion that is missing */
            words: string;
        };
        /**
         * @description A caller. `device` is the number of the browser, program, lab or reading link; 0 is the shell.
         *
         *     A lab is one that this robot has joined: a viewer who may fetch sessions into an archive.
         *     `limited` is a program that may not administer, also not as an operator. `session` is the one session that
         *     a reader may read; None for all others.
         */
        Identity: {
            device: number;
            /** @enum {string} */
            kind: "browser" | "program" | "lab" | "reader" | "shell";
            /** @default false */
            limited: boolean;
            name: string;
            /** @enum {string} */
            role: "viewer" | "operator";
            session: number | null;
        };
        /** @description An imported profile, and its parameters that this robot does not know. */
        Imported: {
            profile: components["schemas"]["Profile"];
            unknown: string[];
        };
        /** @description The IMU's reading along and about the chip's own axes. */
        ImuRaw: {
            /** @description g */
            force: [
                number,
                number,
                number
            ];
            /** @description WHO_AM_I */
            identity: number;
            /** @description °/s */
            rate: [
                number,
                number,
                number
            ];
        };
        /** @description The answer to a robot: the lab's name, its router's port, and the robot's certificate with its key. */
        IssuedMembership: {
            authority: string;
            certificate: string;
            key: string;
            lab: string;
            router_port: number;
        };
        /** @description An export job; its file is stored for some days. */
        Job: {
            /** @description the file's size; null until it is done */
            bytes: number | null;
            /** @description the file's name */
            file: string;
            id: string;
            /**
             * @description the session's identifier; empty for a file of an older version
             * @default
             */
            identifier: string;
            /**
             * Format: date-time
             * @description UTC, time of the request
             */
            made: string;
            /**
             * @description cause of a failure
             * @default
             */
            problem: string;
            /** @description 0 to 1 */
            progress: number;
            session: number;
            session_name: string;
            /** @description the file's checksum, hexadecimal; null until it is done */
            sha256: string | null;
            /** @enum {string} */
            state: "waiting" | "running" | "done" | "failed";
            wanted: components["schemas"]["ExportOptions"];
        };
        /** @description A lab's address, and a code of it. */
        Joining: {
            address: string;
            code: string;
        };
        /** @description A robot that joins by a code: its own page, that page's certificate, and a token for reading it. */
        JoiningRobot: {
            address: string;
            code: string;
            fingerprint: string;
            name: string;
            token: string;
        };
        JsonValue: unknown;
        /** @description The lab that the robot has joined; `name` is null without one. `joined` in s since 1970. */
        LabMembership: {
            address: string;
            /** @description true while the lab's router is connected */
            connected: boolean;
            joined: number | null;
            name: string | null;
        };
        /** @description A saved layout with its document, which may be of another version of the program. */
        LayoutDetails: {
            /** @description the person who saved it; empty where it is not known */
            author: string;
            document: {
                [key: string]: unknown;
            };
            id: number;
            name: string;
            /** Format: date-time */
            saved: string;
            /** @description counts its changes from 1 */
            version: number;
        };
        /** @description The positions of the panels of Operate. */
        LayoutDocument: {
            /** @constant */
            format: "mucat-layout";
            panels: components["schemas"]["PlacedPanel"][];
            version: number;
        };
        /** @description The end of a membership; a lab that is not `notified` lists the robot until it is removed there. */
        LeftLab: {
            notified: boolean;
        };
        /** @description A parameter that was not set, and the reason. */
        LeftOut: {
            name: string;
            why: string;
        };
        /** @description Likeness of the compared parts: the same segments by mode, set point and duration. */
        Likeness: {
            alike: boolean;
            /** @description why not, for a person; empty where they are */
            why: string;
        };
        /** @description The lines of a time range. */
        Lines: {
            sessions: components["schemas"]["SessionLines"][];
        };
        /** @description Sessions, their signals, and their alignment. */
        LinesQuery: {
            align?: components["schemas"]["Align"];
            /** @description columns of each line */
            points?: number;
            /** @description at most one of each session; of the others the one most alike */
            segments?: components["schemas"]["SegmentChoice"][];
            sessions: number[];
            signals: string[];
            /** @description the drawn time range; all of it if null */
            view?: components["schemas"]["TimeRange"] | null;
        };
        /** @description The last fault of the serial line, and the frames before it. */
        LinkFault: {
            frames: components["schemas"]["Dissection"][];
            text: string;
            /** @description s, steady clock */
            time: number;
        };
        /** @description The last hundred frames each way since the port was opened, in the order of time. */
        LinkFrames: {
            /** @description null if there was none since the runtime started */
            fault: components["schemas"]["LinkFault"] | null;
            frames: components["schemas"]["Dissection"][];
            /** @description now, s, steady clock */
            time: number;
        };
        /** @description A topic of the live socket. */
        LiveTopic: {
            /** @description in their order; after the time, 8 bytes, in a row */
            fields: components["schemas"]["LiveTopicField"][];
            /** @description its number in the header of a block */
            id: number;
            /** @enum {string} */
            kind: "rows" | "documents" | "picture";
            meaning: string;
            name: string;
            /** @description whether each document states everything */
            newest_only: boolean;
        };
        /** @description A field of a topic: of rows `count` numbers of struct's type `code`, each times `scale` in `unit`. */
        LiveTopicField: {
            /**
             * @description empty in documents, whose fields are JSON
             * @default
             */
            code: string;
            /** @default 1 */
            count: number;
            /** @default  */
            meaning: string;
            name: string;
            /** @default 1 */
            scale: number;
            /** @default  */
            unit: string;
        };
        /** @description A control loop: depth (m), heading, pitch or roll (rad). */
        Loop: {
            controller: string;
            controllers: components["schemas"]["ControllerChoice"][];
            name: string;
            on: boolean;
            set_point: number;
        };
        /** @description Changes one control loop: all of it or nothing. What is left out stays as it is. */
        LoopCommand: {
            /** @description the controller's name */
            controller?: string | null;
            /** @description by name, of this or the chosen controller */
            gains?: {
                [key: string]: number;
            };
            /** @enum {string} */
            name: "depth" | "heading" | "pitch" | "roll";
            /** @description steer it; in manual: hold it */
            on?: boolean | null;
            /** @description m, of the angles rad */
            set_point?: number | null;
        };
        /**
         * @description A code for one pairing; `expires` in s since 1970, `qr_svg` is a picture of the link.
         *
         *     `other_links` do the same at the server's other addresses; `only_here`: no other computer reaches any.
         */
        MadeCode: {
            code: string;
            expires: number;
            link: string;
            only_here: boolean;
            other_links: string[];
            qr_svg: string;
            /** @enum {string} */
            role: "viewer" | "operator";
        };
        /** @description A code by which one robot joins; `expires` in s since 1970, `command` is for the robot's shell. */
        MadeJoiningCode: {
            address: string;
            code: string;
            command: string;
            expires: number;
        };
        /** @description A reading link with its token, which is shown only this once. */
        MadeReadingLink: {
            link: components["schemas"]["ReadingLink"];
            token: string;
        };
        /** @description A program's token, shown only this once. */
        MadeToken: {
            device: components["schemas"]["DeviceDetails"];
            token: string;
        };
        /** @description Measures the gyroscope's offset for three seconds at rest, and stores it. An event tells the result. */
        MeasureGyroCommand: Record<string, never>;
        /** @description Result of a relay experiment; medians over its cycles, values in the loop's unit. */
        MeasuredLimitCycle: {
            /** @description d: of the command, either way from the bias */
            amplitude: number;
            /** @description share of the cycle by which its halves differ; 0: none */
            asymmetry: number;
            /** @description mean command, which balances the load */
            bias: number;
            cycles: number;
            /** @description ultimate period, s */
            period: number;
            /** @description reasons to doubt these figures */
            remarks: string[];
            /** @description a: half of the height from peak to peak */
            swing: number;
            /** @description command for each unit of the loop */
            ultimate_gain: number;
        };
        /**
         * @description A mission as it stands: sent at its start, at each change, once a second, and at its end.
         *
         *     Each states everything but `document`, which only the first and the last one have.
         */
        Mission: {
            deepest: number;
            /** @default  */
            document: string;
            elapsed: number;
            name: string;
            number: number;
            pause: number;
            paused: number;
            /** @enum {string} */
            phase: "running" | "paused" | "succeeded" | "failed" | "ended";
            progress: number;
            remaining: number;
            sequence: number;
            steps: components["schemas"]["MissionStepState"][];
            surfaced: number | null;
            text: string;
            time: number;
            title: string;
        };
        /** @description The text of a mission. */
        MissionBody: {
            /** @description TOML */
            text: string;
        };
        /** @description A mission's problems by entry, or its summary. */
        MissionCheck: {
            /** @description null if it is not valid */
            plan: components["schemas"]["MissionPlanned"] | null;
            problems: components["schemas"]["EntryProblem"][];
            summary: components["schemas"]["MissionSummary"] | null;
            /** @description what the TOML says; null where it is no TOML */
            table: {
                [key: string]: components["schemas"]["JsonValue"];
            } | null;
            /** @description what steps wait to see and the robot with its vision settings cannot, each with the step's path; empty while the robot does not answer */
            unseen: string[];
        };
        /** @description Ends the mission: its changes are put back, and the robot is stopped. */
        MissionEndCommand: Record<string, never>;
        /** @description A leaf or a branch that documents may have. */
        MissionNodeKind: {
            branch: boolean;
            do: string;
            fields: components["schemas"]["NodeField"][];
            /** @description steps below it at least */
            least: number;
            meaning: string;
            /** @description steps below it at most; null: any */
            most: number | null;
        };
        /** @description Pauses the mission: the robot stays at its depth, and the mission's clocks stand still. */
        MissionPauseCommand: {
            /** @description false: go on */
            on?: boolean;
        };
        /** @description The planned depth over time. */
        MissionPlanned: {
            /** @description false: it is longer, and the rest is left out */
            complete: boolean;
            /** @description in the order of their beginnings */
            steps: components["schemas"]["PlannedMissionStep"][];
        };
        /** @description Ends the running steps of the mission as a success. */
        MissionSkipCommand: Record<string, never>;
        /** @description The first start of a mission's step. */
        MissionStepStart: {
            /** @description from 1 along the branches, as "3.1.2"; empty for the first step */
            path: string;
            /** @description s since the session's start */
            time: number;
            words: string;
        };
        /** @description A step of a running mission. */
        MissionStepState: {
            do: string;
            elapsed: number;
            longest: number;
            note: string;
            path: string;
            rounds: number;
            /** @enum {string} */
            status: "waiting" | "running" | "done" | "failed" | "stopped";
            text: string;
            words: string;
        };
        /** @description A step of a mission. */
        MissionStepSummary: {
            do: string;
            /** @description s that it takes at most */
            longest: number;
            note: string;
            /** @description from 1 along the branches, as "3.1.2"; empty for the first step */
            path: string;
            words: string;
        };
        /** @description The summary of a mission. */
        MissionSummary: {
            /** @description s for which it may go on without the server */
            alone: number;
            /** @description V; its limit; 0: none */
            battery: number;
            /** @description m; its limit */
            depth: number;
            description: string;
            /** @description s that it takes at most, without pauses */
            longest: number;
            name: string;
            /** @description s that it may be paused in all */
            pause: number;
            steps: components["schemas"]["MissionStepSummary"][];
            /** @description s; its limit */
            time: number;
            title: string;
            /** @description s; its limit; 0: none */
            unwatched: number;
        };
        /** @description A mission; `shipped` ones are part of the program, the others are in the data folder. */
        MissionText: {
            /** @description tells this text from others */
            mark: string;
            name: string;
            shipped: boolean;
            /** @description null if it is not valid */
            summary: components["schemas"]["MissionSummary"] | null;
            /** @description TOML */
            text: string;
            title: string;
            versions: number;
        };
        /** @description The running trial, or the last one. */
        MissionTrial: {
            name: string;
            /** @description the reason of an early end; empty without one */
            problem: string;
            results: components["schemas"]["MissionTrialResult"][];
            /** @description 16 hexadecimal digits, never used again; empty: there was none */
            run: string;
            running: boolean;
            seeds: number;
            /** @description the mission's TOML */
            text: string;
        };
        /** @description The outcome with one seed. `phase` is null where the mission did not begin; `text` says why. */
        MissionTrialResult: {
            /** @description depth, m, twice a second from its start to its end */
            curve: number[];
            /** @description m */
            deepest: number;
            /** @description s */
            elapsed: number;
            /** @description path of the step that failed */
            failed: string | null;
            phase: ("running" | "paused" | "succeeded" | "failed" | "ended") | null;
            seed: number;
            text: string;
        };
        /** @description A version of the user's own mission. */
        MissionVersion: {
            /** @description empty where it is not known */
            author: string;
            /** @description s since 1970 */
            made: number;
            /** @description TOML */
            text: string;
            version: number;
        };
        /** @description Lets the pilot or the depth controller steer the armed robot. */
        ModeCommand: {
            /**
             * @description who steers: controller or pilot
             * @enum {string}
             */
            mode: "automatic" | "manual";
        };
        /** @description An event; `time` in s since the session's start, `kind` one word for programs. */
        Moment: {
            kind: string;
            /** @enum {string} */
            severity: "info" | "caution" | "alarm";
            text: string;
            time: number;
        };
        /** @description A new bookmark; its time in s since the session's start, or null for now. `text` is Markdown. */
        NewBookmark: {
            text?: string;
            time?: number | null;
        };
        /** @description A pairing code to be made. */
        NewCode: {
            /** @enum {string} */
            role?: "viewer" | "operator";
        };
        /** @description A new export. */
        NewExport: {
            /** @description such as depth.depth or motor.angle_0; null for all. For csv-grid alone */
            columns?: string[] | null;
            /**
             * @description of the chunks of mcap; zstd and lz4 need their packages
             * @enum {string}
             */
            compression?: "none" | "zstd" | "lz4";
            /** @description s since the session's start; null for its end */
            end?: number | null;
            /** @enum {string} */
            format: "csv" | "csv-grid" | "xlsx" | "parquet" | "mcap" | "archive" | "report" | "mp4";
            /**
             * @description values over the film of mp4: as subtitles, which a player shows or hides, or as the flight view's lines, drawn into each picture
             * @enum {string}
             */
            overlay?: "none" | "subtitles" | "lines";
            /** @description s between the lines of csv-grid */
            period?: number;
            session: number;
            /**
             * @description none: CSV for programs; point, comma: for a spreadsheet with this decimal sign, with a byte order mark, and for comma with semicolons. For csv and csv-grid
             * @enum {string}
             */
            spreadsheet?: "none" | "point" | "comma";
            /** @description s since the session's start; null for its beginning */
            start?: number | null;
            /** @description names of topics; null for all. Not for csv-grid, archive and report */
            topics?: string[] | null;
        };
        /** @description A layout to be saved under a name. */
        NewLayout: {
            /** @description the version that it replaces, 0 for a new layout: refused if somebody has saved another since. null replaces any */
            base?: number | null;
            document: components["schemas"]["LayoutDocument"];
            name: string;
        };
        /** @description A mission to be stored. */
        NewMission: {
            /** @description `mark` of the version that the editing began from, empty for a new mission: refused if somebody has changed it since. null replaces any */
            base?: string | null;
            /** @description TOML */
            text: string;
        };
        /** @description The name under which the present parameters are saved. */
        NewProfile: {
            name: string;
            note?: string;
        };
        /** @description A session, and the end of the link (s since 1970). */
        NewReadingLink: {
            ends: number;
            session: number;
        };
        /** @description A scenario to be stored. */
        NewScenario: {
            /** @description `mark` of the text that the editing began from, empty for a new scenario: refused if somebody has changed it since. null replaces any */
            base?: string | null;
            /** @description TOML */
            text: string;
        };
        /** @description A new session; its default name is its date and time. */
        NewSession: {
            name?: string;
            note?: string;
        };
        /** @description A program that gets a token. */
        NewToken: {
            /** @description until it ends; null: it never ends */
            days?: number | null;
            name: string;
            /** @enum {string} */
            scope?: "read" | "operate" | "administer";
        };
        /** @description The second best variant: by how much its figure exceeds the best one's, paired by equal seeds. */
        NextBest: {
            difference: number;
            high: number | null;
            low: number | null;
            variant: number;
        };
        /** @description A field of a leaf or a branch. */
        NodeField: {
            default: number | string | boolean | null;
            /** @enum {string} */
            kind: "number" | "whole" | "text" | "value" | "sight" | "parameter" | "mission";
            maximum: number | null;
            meaning: string;
            minimum: number | null;
            name: string;
            required: boolean;
            unit: string;
        };
        /** @description A panel, named by its file; `problem` is the reason why it cannot be shown. */
        OwnPanel: {
            name: string;
            /** @default  */
            problem: string;
        };
        /** @description A panel's file: an ES module. */
        OwnPanelScript: {
            name: string;
            script: string;
        };
        /** @description The period, s, at which the board sends a topic at this baud rate. */
        Pace: {
            period: number;
            topic: string;
        };
        /** @description The caller after pairing. */
        Paired: {
            /** @description why the sign-in that was shown counts no longer; else empty */
            ended: string;
            /** @description end of the caller's token or reading link, s since 1970 */
            ends: number | null;
            identity: components["schemas"]["Identity"] | null;
            /** @description true where this server is a lab's, which has no robot */
            lab: boolean;
            /** @description names of the operations that the caller's role may not call; a reader's are all that do not read the session of the link */
            operators_only: string[];
            /** @description shown only this once; null where the browser was signed in already */
            page_secret: string | null;
            pairing_open: boolean;
            robot: string;
            signed_in: boolean;
        };
        /** @description A code, and a name for this browser. */
        Pairing: {
            code: string;
            name: string;
        };
        /** @description Every parameter; sent at each change and every ten seconds. */
        Parameters: {
            parameters: components["schemas"]["TunableParameter"][];
            time: number;
        };
        /** @description Sets parameters by name, all or none, between two control ticks. */
        ParametersCommand: {
            /** @description refused where one has another value now */
            expected?: {
                [key: string]: number | string | boolean;
            };
            /** @description leave out what cannot be set, instead of refusing all */
            partly?: boolean;
            values: {
                [key: string]: number | string | boolean;
            };
        };
        /** @description The health of a part: its state, and a sentence about it. */
        PartHealth: {
            /** @description true if a simulator that can be started and ended runs on this computer */
            here: boolean | null;
            /** @enum {string} */
            name: "server" | "database" | "runtime" | "link" | "board" | "simulator" | "scene" | "camera" | "events" | "router" | "robots";
            /** @enum {string} */
            state: "ok" | "starting" | "failed" | "absent" | "unknown";
            text: string;
        };
        /** @description A run of a mission that a session recorded. Times are s since the session's start. */
        PastMissionRun: {
            /** @description m */
            deepest: number;
            /** @description s of the mission's clock */
            elapsed: number;
            end: number;
            /**
             * @description still running where the recording lacks its end
             * @enum {string}
             */
            phase: "running" | "paused" | "succeeded" | "failed" | "ended";
            session: components["schemas"]["Session"];
            start: number;
            /** @description how it ended */
            text: string;
        };
        /** @description A point of the picture that was clicked. */
        PickPlace: {
            /** @description of the circle that is examined, as a share of the width */
            radius?: number;
            /** @description share of the picture's width */
            x: number;
            /** @description share of its height */
            y: number;
        };
        /** @description A colour range, the share of the picture within it, and the mask that it would have. */
        PickedColour: {
            colour: components["schemas"]["ColourRange-Output"];
            /** @description a JPEG file, in base64 */
            mask: string;
            share: number;
        };
        /** @description Bytes of one picture of a film, by quality. */
        PictureBytes: {
            high: number;
            low: number;
            medium: number;
        };
        /** @description A panel, and its position in columns and rows of the grid from the upper left corner. */
        PlacedPanel: {
            chart?: components["schemas"]["ShownChart"] | null;
            height: number;
            id: string;
            panel: string;
            width: number;
            x: number;
            y: number;
        };
        /** @description One doing of a leaf, as it is expected if no step fails. */
        PlannedMissionStep: {
            /** @description s since the mission's start */
            end: number;
            /** @description m */
            end_depth: number;
            /** @description false: its end depends on what happens, and is drawn 5 s on at most */
            known: boolean;
            /** @description of the step, as in its summary */
            path: string;
            /** @description s since the mission's start */
            start: number;
            /** @description m */
            start_depth: number;
        };
        /** @description A measured signal of the session that was left out, and its prediction; null breaks the lines. */
        PredictedChannel: {
            after: (number | null)[];
            after_rms: number;
            before: (number | null)[];
            /** @description error of the prediction by the craft before the fit */
            before_rms: number;
            measured: (number | null)[];
            name: string;
            unit: string;
        };
        /** @description A predicted step response: at most 30 s after the step. */
        PredictedStep: {
            curve: components["schemas"]["TuningCurve"];
            /** @description by name, as of a run */
            figures: {
                [key: string]: components["schemas"]["Figure"];
            };
            /** @description title of the craft that was simulated */
            model: string;
            /** @description why it ended early; empty if it did not */
            problem: string;
        };
        /** @description A step, with the controller and the gains by which it is predicted. */
        PredictionQuery: {
            controller: string;
            /** @description by name; what is left out has its default */
            gains: {
                [key: string]: number;
            };
            step: components["schemas"]["StepStart"];
        };
        /** @description A robot as it is now. A robot that has left the lab says so with its last presence. */
        Presence: {
            /** @description of its own page; empty where that is for its computer alone */
            address: string;
            alarms: components["schemas"]["PresentAlarm"][];
            armed: boolean;
            /** @description V; null without a recent one */
            battery: number | null;
            /** @description s until the low-battery alarm, estimated */
            battery_left: number | null;
            /** @description true while its board answers */
            connected: boolean;
            /** @description m; null without a recent one */
            depth: number | null;
            /** @description bytes */
            disk_free: number;
            /** @description bytes */
            disk_total: number;
            /** @description of its certificate; empty without TLS */
            fingerprint: string;
            /** @default false */
            left: boolean;
            /** @description null where none is going on */
            mission: components["schemas"]["PresentMission"] | null;
            /** @description null while its runtime is silent */
            mode: ("disarmed" | "manual" | "automatic" | "test" | "failsafe") | null;
            /** @description name of the session being recorded */
            recording: string | null;
            software: string;
        };
        /** @description An active alarm of a robot. */
        PresentAlarm: {
            /** @enum {string} */
            severity: "info" | "caution" | "alarm";
            what: string;
        };
        /** @description The mission that a robot carries out, or has carried out last; `progress` from 0 to 1. */
        PresentMission: {
            /** @enum {string} */
            phase: "running" | "paused" | "succeeded" | "failed" | "ended";
            progress: number;
            title: string;
        };
        /** @description The firmware that was on the board before the last upload of another one. */
        PreviousFirmware: {
            /** @description on the robot's computer */
            path: string;
            /** Format: date-time */
            since: string;
        };
        /**
         * @description An error: what happened, why, and what to do.
         *
         *     `problems` are those of a document or a request, by entry. `kind` is `confirmation` where a browser must
         *     confirm first, by `POST /api/access/confirm`, and `changed` where somebody else has changed the thing
         *     since the editing began.
         */
        Problem: {
            detail: string;
            /**
             * @default
             * @enum {string}
             */
            kind: "" | "confirmation" | "changed";
            /** @default [] */
            problems: components["schemas"]["EntryProblem"][];
        };
        /** @description Parameters saved under a name. */
        Profile: {
            /** @description the person who saved it; empty where it is not known */
            author: string;
            id: number;
            name: string;
            note: string;
            /**
             * Format: date-time
             * @description UTC
             */
            saved: string;
            values: {
                [key: string]: boolean | number | string;
            };
        };
        /** @description A profile's file, as text. */
        ProfileText: {
            text: string;
        };
        /** @description Gains by a named rule. */
        Proposal: {
            gains: {
                [key: string]: number;
            };
            known_for: string;
            /** @description why these cannot be set; empty if they can */
            problem: string;
            rule: string;
            source: string;
            title: string;
        };
        /** @description A queued run. */
        QueuedRun: {
            name: string;
            /** @description 16 hexadecimal digits, never used again */
            run: string;
            title: string;
        };
        /** @description The best variant with its 95 % interval. */
        RankedBest: {
            high: number | null;
            low: number | null;
            mean: number;
            next: components["schemas"]["NextBest"] | null;
            variant: number;
        };
        /** @description The newest raw readings of all parts. */
        RawReadings: {
            battery_volts: number;
            beacons: components["schemas"]["BeaconLevels"];
            encoders: components["schemas"]["EncoderReading"][];
            imu: components["schemas"]["ImuRaw"] | null;
            /** @description the leak sensor is wet */
            leak: boolean;
            pressure_hpa: number | null;
            /** @description °C */
            temperature: number | null;
        };
        /** @description A reading link; times in s since 1970. `used` is null where nobody has opened it. */
        ReadingLink: {
            /** @description why it lets nobody in any more; else empty */
            ended: string;
            ends: number;
            id: number;
            made: number;
            session: number;
            used: number | null;
        };
        /** @description The token of a reading link. */
        ReadingToken: {
            token: string;
        };
        /** @description The robot's values at a moment; null where none was measured within 2 s before. */
        Readings: {
            /** @description V */
            battery: number | null;
            /** @description of the depth's controller, -1 to 1, downwards */
            command: number | null;
            /** @description m */
            depth: number | null;
            /** @description front right, back right, back left, front left; or empty */
            fins: components["schemas"]["FinReading"][];
            /** @description rad */
            heading: number | null;
            /** @description rad */
            pitch: number | null;
            /** @description rad */
            roll: number | null;
            /** @description m, also while no depth is held */
            set_point: number | null;
            /** @description s since the session's start */
            time: number;
        };
        /** @description One column of a topic, as it is exported. */
        RecordedColumn: {
            meaning: string;
            name: string;
            unit: string;
        };
        /** @description A craft that the simulator swam from `time` on. */
        RecordedCraft: {
            /** @description the craft file, with all its numbers */
            file: string;
            origin: string;
            /** @description s since the session's start */
            time: number;
            title: string;
        };
        /** @description A mission of a session. Times are s since the session's start. */
        RecordedMission: {
            /** @description TOML; empty where the recording lacks its first and last state */
            document: string;
            end: number;
            /** @description it had begun before the recording */
            late: boolean;
            /** @description its last state; still running where the recording lacks its end */
            mission: components["schemas"]["Mission"];
            start: number;
            /** @description the steps that began, in the order of the document */
            started: components["schemas"]["MissionStepStart"][];
        };
        /** @description A recorded topic; times are of the first and the last sample, s since the session's start. */
        RecordedTopic: {
            columns: components["schemas"]["RecordedColumn"][];
            count: number;
            first: number;
            /** @enum {string} */
            kind: "rows" | "documents" | "picture" | "film";
            last: number;
            meaning: string;
            name: string;
        };
        /** @description A relay in place of a loop's controller. */
        RelayStart: {
            /** @description d, share of the largest command */
            amplitude: number;
            /** @description number of measured cycles */
            cycles: number;
            /** @description s after which it gives up */
            duration: number;
            /** @description m, of an angle rad */
            high: number;
            /** @description ε, in the loop's unit */
            hysteresis: number;
            /**
             * @description discriminator enum property added by openapi-typescript
             * @enum {string}
             */
            kind: "relay";
            /** @enum {string} */
            loop?: "depth" | "heading" | "pitch" | "roll";
            /** @description m, of an angle rad */
            low: number;
            /** @description m, of an angle rad */
            set_point: number;
        };
        /** @description The parameters that a command changed, and those that it omitted. */
        Restored: {
            changed: components["schemas"]["ChangedValue"][];
            left_out: components["schemas"]["LeftOut"][];
        };
        /** @description The pull from one robot of the lab, and what the archive has of it. */
        RobotPull: {
            /** @description sessions that the archive lacks, as of the last look */
            lacking: number;
            /** @enum {string} */
            phase: "waiting" | "pulling" | "done" | "armed" | "unreachable" | "failed";
            /** @description sessions that cannot be pulled, and why; at most ten */
            problems: string[];
            /** @description from 0 to 1, of the session that is being pulled */
            progress: number;
            /** @description UTC; when the last of them was pulled; null before */
            pulled: string | null;
            /** @description its name, as in `GET /api/robots` */
            robot: string;
            /** @description UTC; when it answered last, since the lab was started */
            seen: string | null;
            /** @description its sessions in the archive, as of the last look */
            sessions: number;
            /** @description what it does, or why it does not, as a sentence */
            text: string;
        };
        /** @description The lab's robots by name; `problem` says why none can be heard, empty otherwise. */
        RosterDetails: {
            problem: string;
            robots: components["schemas"]["RosterRobot"][];
        };
        /** @description A robot that has joined the lab, and its last presence. */
        RosterRobot: {
            /** @description of its own page; empty where that is open to no other computer */
            address: string;
            /** @description s by which its clock is ahead of the lab's; null until measured */
            clock_offset: number | null;
            /** @description m; of the last minute, once a second */
            depths: (number | null)[];
            /** @description s since 1970 */
            joined: number;
            name: string;
            presence: components["schemas"]["Presence"] | null;
            /** @description false where it is not heard now */
            present: boolean;
            /** @description s since its last presence; null before the first */
            seen: number | null;
        };
        /** @description A run; `sample` is the name of a shipped one, and empty for others. */
        RunSummary: {
            /** @description number in the document */
            cells: number;
            cells_done: number;
            /** @enum {string} */
            direction: "to_board" | "to_host" | "both";
            /** @description UTC; null while it runs */
            ended: string | null;
            framing: string;
            id: number;
            name: string;
            /** @enum {string} */
            place: "emulated" | "robot";
            problem: string;
            /** @description null without cells */
            rate_mean: number | null;
            rate_min: number | null;
            sample: string;
            /**
             * Format: date-time
             * @description UTC
             */
            started: string;
            /** @enum {string} */
            state: "running" | "complete" | "cancelled" | "failed" | "interrupted";
        };
        /** @description A layout by its name. */
        SavedLayout: {
            /** @description the person who saved it; empty where it is not known */
            author: string;
            id: number;
            name: string;
            /** Format: date-time */
            saved: string;
            /** @description counts its changes from 1 */
            version: number;
        };
        /** @description A scenario's problems, field by field, or its summary. */
        ScenarioCheck: {
            problems: components["schemas"]["EntryProblem"][];
            summary: components["schemas"]["ScenarioSummary"] | null;
        };
        /** @description The text of a scenario. */
        ScenarioDocument: {
            /** @description TOML */
            text: string;
        };
        /** @description An event of a scenario. */
        ScenarioEvent: {
            /** @description s */
            at: number;
            do: string;
            words: string;
        };
        /** @description A kind of event, beside its time. */
        ScenarioEventKind: {
            do: string;
            fields: components["schemas"]["EventField"][];
            meaning: string;
        };
        /**
         * @description A scenario to run: on the robot in real time, or in simulated time.
         *
         *     `board`, in simulated time alone: the firmware built for this computer, or on the emulated board.
         */
        ScenarioStart: {
            /** @enum {string} */
            board?: "host" | "emulated";
            /** @enum {string} */
            place: "live" | "simulated";
            /** @description TOML */
            text: string;
        };
        /** @description The run that was started. */
        ScenarioStarted: {
            /** @description 16 hexadecimal digits, never used again */
            run: string;
        };
        /** @description The active run, the queue and the last run. */
        ScenarioState: {
            active: components["schemas"]["ActiveRun"] | null;
            last: components["schemas"]["EndedRun"] | null;
            queued: components["schemas"]["QueuedRun"][];
        };
        /** @description The summary of a scenario. */
        ScenarioSummary: {
            /** @description title of the depth controller */
            controller: string;
            description: string;
            /** @description s */
            duration: number;
            events: components["schemas"]["ScenarioEvent"][];
            name: string;
            /** @enum {string} */
            scene: "pool" | "natural";
            seed: number;
            title: string;
        };
        /** @description A scenario; `shipped` ones are part of the program, the others are in the data folder. */
        ScenarioText: {
            /** @description tells this text from others */
            mark: string;
            name: string;
            shipped: boolean;
            /** @description null if it is not valid */
            summary: components["schemas"]["ScenarioSummary"] | null;
            /** @description TOML */
            text: string;
            title: string;
        };
        /** @description The bystander's view; all pages share it. */
        SceneView: {
            /** @description ° of the line of sight, from heading or north */
            azimuth: number;
            /** @description m */
            distance: number;
            /** @description ° above the robot */
            elevation: number;
            /**
             * @description follow turns with the robot, the others do not
             * @enum {string}
             */
            name: "follow" | "side" | "top";
        };
        /** @description A time in which the robot was armed and nothing was changed; s since the session's start. */
        Segment: {
            /** @description empty where no depth was held */
            controller: string;
            end: number;
            /** @description by name */
            gains: {
                [key: string]: number;
            };
            holds_depth: boolean;
            /** @description empty where the recording lacks it */
            mode: string;
            /** @description m; null where no depth was held, or where it changed on and on */
            set_point: number | null;
            start: number;
            /** @description the controller's name for a person */
            title: string;
        };
        /** @description A segment of a session. */
        SegmentChoice: {
            /** @description from 1 on, in order of time */
            segment: number;
            session: number;
        };
        /** @description One recording; "interrupted" if the server ended without closing it: its stored samples remain. */
        Session: {
            /** @description UTC; time at which a lab said that it has it; null before */
            archived: string | null;
            /** @description bytes stored, compressed */
            bytes: number;
            /** @description hash of the packet definitions, 8 hexadecimal digits */
            definitions: string;
            /** @description UTC; time of its deletion, while it is in the bin */
            deleted: string | null;
            /** @description s, up to the last samples that are stored */
            duration: number;
            /** @description UTC; null while it records */
            ended: string | null;
            /**
             * @description whether the camera was filmed
             * @default false
             */
            film: boolean;
            /** @description hash of the firmware, 16 hexadecimal digits; empty where unknown */
            firmware: string;
            id: number;
            /** @description the same wherever it is imported, 32 hexadecimal digits */
            identifier: string;
            /** @description protected from the rules of retention */
            kept: boolean;
            /** @description number of bookmarks */
            markers: number;
            name: string;
            note: string;
            /**
             * @description started by an operator, arming, a scenario in real or in simulated time; or imported
             * @enum {string}
             */
            origin: "operator" | "arming" | "scenario" | "simulated" | "import";
            robot: string;
            /** @description samples stored, all topics together */
            samples: number;
            /** @description empty without a scenario */
            scenario_name: string;
            seed: number | null;
            /** @description hash of the runtime's sources, 16 hexadecimal digits, or empty */
            software: string;
            /**
             * Format: date-time
             * @description UTC
             */
            started: string;
            /** @enum {string} */
            state: "recording" | "complete" | "interrupted";
            /** @description null while it records, and until its samples have been read */
            summary: components["schemas"]["SessionSummary"] | null;
            /** @description in alphabetical order */
            tags: string[];
            /** @description of the server that recorded it */
            version: string;
        };
        /** @description A session's texts at the beginning of an editing; null: not compared. */
        SessionBase: {
            name?: string | null;
            note?: string | null;
            tags?: string[] | null;
        };
        /** @description Changes of a session's texts; null leaves a field unchanged. */
        SessionChanges: {
            /** @description what the changed texts were when the editing began: refused if somebody has changed one of them since. null replaces any */
            base?: components["schemas"]["SessionBase"] | null;
            kept?: boolean | null;
            name?: string | null;
            note?: string | null;
            tags?: string[] | null;
        };
        /** @description A session with all data except the samples. */
        SessionDetail: {
            /** @description UTC; time at which a lab said that it has it; null before */
            archived: string | null;
            /** @description bytes stored, compressed */
            bytes: number;
            /** @description robot.toml as it was at the start */
            configuration: string;
            /** @description the simulated ones, in order of time; none of real water, and of older versions */
            crafts: components["schemas"]["RecordedCraft"][];
            /** @description hash of the packet definitions, 8 hexadecimal digits */
            definitions: string;
            /** @description UTC; time of its deletion, while it is in the bin */
            deleted: string | null;
            /** @description s, up to the last samples that are stored */
            duration: number;
            /** @description UTC; null while it records */
            ended: string | null;
            /**
             * @description whether the camera was filmed
             * @default false
             */
            film: boolean;
            /** @description hash of the firmware, 16 hexadecimal digits; empty where unknown */
            firmware: string;
            /** @description number of all gaps */
            gap_count: number;
            /** @description in the order of their times, the first 2000 */
            gaps: components["schemas"]["SessionGap"][];
            id: number;
            /** @description the same wherever it is imported, 32 hexadecimal digits */
            identifier: string;
            /** @description protected from the rules of retention */
            kept: boolean;
            /** @description number of bookmarks */
            markers: number;
            /** @description in the order of their times, the first 2000; `markers` counts all */
            marks: components["schemas"]["Bookmark"][];
            name: string;
            note: string;
            /**
             * @description started by an operator, arming, a scenario in real or in simulated time; or imported
             * @enum {string}
             */
            origin: "operator" | "arming" | "scenario" | "simulated" | "import";
            robot: string;
            /** @description the `state` document at the start */
            robot_state: {
                [key: string]: unknown;
            } | null;
            /** @description samples stored, all topics together */
            samples: number;
            /** @description TOML; empty without one */
            scenario: string;
            /** @description empty without a scenario */
            scenario_name: string;
            seed: number | null;
            /** @description hash of the runtime's sources, 16 hexadecimal digits, or empty */
            software: string;
            /**
             * Format: date-time
             * @description UTC
             */
            started: string;
            /** @enum {string} */
            state: "recording" | "complete" | "interrupted";
            /** @description null while it records, and until its samples have been read */
            summary: components["schemas"]["SessionSummary"] | null;
            /** @description in alphabetical order */
            tags: string[];
            topics: components["schemas"]["RecordedTopic"][];
            /** @description of the server that recorded it */
            version: string;
            /**
             * @description simulated, or real: no simulator has sent anything
             * @enum {string}
             */
            water: "simulated" | "real" | "unknown";
        };
        /** @description A session that has ended, as a lab compares it with its archive. */
        SessionEdits: {
            /** @description true once a lab has said that it has it */
            archived: boolean;
            /** @description number of the changes of its texts, dates and bookmarks */
            edits: number;
            id: number;
            identifier: string;
            name: string;
        };
        /** @description Samples that are missing in the session: `missed` of them, noticed at `time`. */
        SessionGap: {
            /** @enum {string} */
            kind: "missed" | "restarted" | "not stored" | "damaged" | "removed";
            missed: number;
            /** @description s since the session's start */
            time: number;
            topic: string;
        };
        /** @description Sessions that follow each other in the list. */
        SessionGroup: {
            count: number;
            /** @description a day such as 2026-05-31, a scenario or a mission; empty: without one */
            name: string;
        };
        /** @description One session's lines. */
        SessionLines: {
            id: number;
            /** @description the moment that is 0 s, s since its start; null if it lacks that */
            offset: number | null;
            /** @description why it cannot be aligned; empty if it can */
            problem: string;
            /** @description by signal; missing signals are left out */
            series: {
                [key: string]: components["schemas"]["SignalLine"];
            };
        };
        /** @description The run of the scenario that makes a session. */
        SessionRun: {
            run: string;
        };
        /** @description The summary of an ended session, for the list. Values that its samples lack are null or empty. */
        SessionSummary: {
            /** @description number of alarms that began */
            alarms: number;
            /** @description s, all armed times together */
            armed: number;
            /** @description colours that were before the camera, in the order of their times */
            cards: string[];
            /** @description titles of those that held the depth while armed */
            controllers: string[];
            /** @description m, the greatest depth of each of equal parts of its duration; null: none was measured */
            curve: (number | null)[];
            /** @description true: a part of the samples cannot be read, and is not in here */
            damaged: boolean;
            /** @description m, the greatest */
            depth: number | null;
            /** @description s since the start: from here on the first small picture shows a card, or the deepest moment; null without pictures */
            face: number | null;
            /** @description name of the first one; empty without */
            mission: string;
            /** @description in which it was while armed */
            modes: string[];
        };
        /** @description A chart's signals, by the names in recordings (`motor.angle_2`), and its length in s. */
        ShownChart: {
            seconds: number;
            signals: string[];
        };
        /** @description One number over time; `name` is topic and column, joined by a dot. */
        Signal: {
            column: string;
            meaning: string;
            name: string;
            topic: string;
            unit: string;
        };
        /** @description A signal over time, decimated to minimum and maximum of each column; null breaks the line. */
        SignalLine: {
            high: (number | null)[];
            low: (number | null)[];
            /** @description s since the session's start */
            time: number[];
        };
        /** @description Two signals at the same times, in order of time. */
        SignalPair: {
            /** @description s since the session's start */
            time: number[];
            x: components["schemas"]["Signal"];
            x_values: number[];
            y: components["schemas"]["Signal"];
            y_values: number[];
        };
        /** @description The computer of the simulator; `here`: this one. */
        SimulatorPlace: {
            here: boolean;
        };
        /** @description The moment of a snapshot and the robot's values then; null where none was measured. */
        SnapshotValues: {
            /** @description m */
            depth: number | null;
            /** @description rad */
            heading: number | null;
            /** @description rad */
            pitch: number | null;
            position: components["schemas"]["EstimatedPosition"] | null;
            /** @description rad */
            roll: number | null;
            /** @description s since the session's start */
            time: number;
            /** @description the same moment, s since 1970 */
            utc: number;
        };
        /** @description The one-sided power spectral density of a signal by Welch's method; its integral is the variance. */
        Spectrum: {
            /** @description in the signal's unit, squared, per Hz */
            density: number[];
            /** @description Hz */
            frequency: number[];
            /** @description null for a constant */
            peak: components["schemas"]["SpectrumPeak"] | null;
            /** @description why there is no spectrum; empty if there is one */
            problem: string;
            /** @description Hz, of the even grid that the samples were laid on */
            rate: number;
            /** @description number of averaged periodograms */
            segments: number;
            signal: components["schemas"]["Signal"];
        };
        /** @description The highest place of a spectrum, as the sine that would make it. */
        SpectrumPeak: {
            /** @description in the signal's unit */
            amplitude: number;
            /** @description Hz */
            frequency: number;
            /** @description of the signal's variance, 0 to 1 */
            share: number;
        };
        /** @description The first run of the document. */
        Started: {
            run: number;
        };
        /** @description The robot as a whole; sent once a second and at every change. */
        State: {
            alarms: components["schemas"]["Alarm"][];
            armed: boolean;
            armed_since: number | null;
            battery_left: number | null;
            baud: number;
            /** @default true */
            buoyancy_known: boolean;
            camera: string;
            card: string | null;
            cards: string[];
            colours: string[];
            connected: boolean;
            connection: string;
            control_rate: number;
            /** @default 10 */
            deepest: number;
            epoch: number | null;
            loops: components["schemas"]["Loop"][];
            /** @enum {string} */
            mode: "disarmed" | "manual" | "automatic" | "test" | "failsafe";
            paces: components["schemas"]["Pace"][];
            /** @default 0 */
            pilot_dropped: number;
            port: string;
            /**
             * @default full
             * @enum {string}
             */
            profile: "full" | "lean";
            refusals: string[];
            run: string;
            set_point_default: number;
            set_point_detected: number;
            /**
             * @default none
             * @enum {string}
             */
            steering: "none" | "beacons";
            /** @default 15 */
            stream_rate: number;
            time: number;
            /** @default 0 */
            unwatched: number;
            vision_colour: string;
            vision_rate: number;
        };
        /** @description A time without samples of the robot's state; s since the session's start. */
        StateSilence: {
            end: number;
            start: number;
        };
        /** @description Chooses the course while the robot holds its depth. */
        SteeringCommand: {
            /**
             * @description none: stay; beacons: swim to the light that its detectors see
             * @enum {string}
             */
            by: "none" | "beacons";
        };
        /** @description A step of a loop's set point. */
        StepStart: {
            /** @description s from the step on */
            duration: number;
            /** @description m, of an angle rad */
            high: number;
            /**
             * @description discriminator enum property added by openapi-typescript
             * @enum {string}
             */
            kind: "step";
            /** @enum {string} */
            loop?: "depth" | "heading" | "pitch" | "roll";
            /** @description m, of an angle rad */
            low: number;
            /** @description longest time at the start, s */
            settle: number;
            /** @description m, of an angle rad */
            start: number;
            /** @description m, of an angle rad */
            target: number;
            /** @description largest distance from the start that counts as settled */
            tolerance: number;
        };
        /** @description The answers of one robot to STOP; `zenoh` and `https` are empty where it has answered that way. */
        StoppedRobot: {
            https: string;
            name: string;
            stopped: boolean;
            zenoh: string;
        };
        /** @description Use of the disk that holds the data folder, and the rules of retention. */
        Storage: {
            /** @description bytes of the copies in the folder `backups`, unfinished ones included */
            backups: number;
            /** @description number of sessions in the bin */
            bin: number;
            bin_bytes: number;
            /** @description bytes of the database's files */
            database: number;
            /** @description bytes of the exported files */
            exports: number;
            /** @description bytes of the films of all sessions, those in the bin included */
            film_bytes: number;
            /** @description free bytes of this disk */
            free: number;
            /** @description days after which a session is moved to the bin; 0: never */
            keep_days: number;
            /** @description GB to keep free by removing the oldest sessions; 0: no such rule */
            keep_free: number;
            /** @description number of sessions that are being removed for good */
            removing: number;
            /** @description bytes of these that are still to be removed */
            removing_bytes: number;
            /** @description of these, bytes that are free for reuse */
            reusable: number;
            /** @description number of sessions, without the bin */
            sessions: number;
            sessions_bytes: number;
            /** @description bytes of this disk */
            total: number;
            /** @description days in the bin before a session is removed */
            undo_days: number;
        };
        /** @description A session as one dive; times are s since its start. */
        Story: {
            /** @description m; null where the session has none */
            depth: components["schemas"]["SignalLine"] | null;
            duration: number;
            /** @description in order of time; of too many the gravest */
            flags: components["schemas"]["Flag"][];
            /** @description number of all segments */
            segment_count: number;
            /** @description in order of time, the first 200 */
            segments: components["schemas"]["Segment"][];
            /** @description m, while the depth was held; null where it never was */
            set_point: components["schemas"]["SignalLine"] | null;
            /** @enum {string} */
            water: "simulated" | "real" | "unknown";
        };
        /** @description The figures of a dive, by name. */
        StoryFigures: {
            meanings: components["schemas"]["FigureMeaning"][];
            /** @description in the order of the story's segments, the first 200; empty for a chosen part */
            segments: {
                [key: string]: components["schemas"]["Figure"];
            }[];
            /** @description of the armed time, or of the chosen part */
            whole: {
                [key: string]: components["schemas"]["Figure"];
            };
        };
        /** @description The best variant by now: its values in the order of the parameters, the mean of the best figure. */
        SweepBest: {
            mean: number;
            values: (number | string | null)[];
            variant: number;
        };
        /** @description A sweep with its document and what came of it by now. */
        SweepDetail: {
            best: components["schemas"]["RankedBest"] | null;
            best_figure: string;
            done: number;
            ended: number | null;
            failed: number;
            failures: components["schemas"]["FailureCount"][];
            figures: components["schemas"]["FigureMeaning"][];
            id: number;
            /** @description by figures: a variant whose mean is beyond one is not the best */
            limits: {
                [key: string]: number;
            };
            made: number;
            name: string;
            parameters: components["schemas"]["SweepParameter"][];
            /** @description why it failed, or what it waits for; empty otherwise */
            problem: string;
            /** @description s; null where not known */
            remaining: number | null;
            runs: number;
            scenario: string;
            started: number | null;
            /** @enum {string} */
            state: "running" | "waiting" | "complete" | "cancelled" | "failed" | "interrupted";
            text: string;
            title: string;
            variants: components["schemas"]["SweepVariant"][];
            who: string;
            /** @description runs that are computed at once; 0 while it does not run */
            workers: number;
        };
        /** @description The text of a sweep. */
        SweepDocument: {
            /** @description TOML */
            text: string;
        };
        /** @description An entry of the scenario that varies. */
        SweepParameter: {
            /** @description each seed draws its own value, the same in every variant */
            by_seed: boolean;
            /** @enum {string} */
            kind: "list" | "range" | "random" | "search";
            label: string;
            /** @description its path in the scenario */
            name: string;
            unit: string;
            /** @description of a list, a range or samples; of one by the seed, of a search: the least, the most */
            values: (number | string)[];
        };
        /** @description A sweep's problems, entry by entry, or what it will do. */
        SweepPlan: {
            parameters: components["schemas"]["SweepParameter"][];
            problems: components["schemas"]["EntryProblem"][];
            runs: number;
            /** @description that it takes, by the runs measured so far; null where none is */
            seconds: number | null;
            /** @description of its first 5000 runs, how many are computed already; of a search 0 */
            stored: number;
            variants: number;
            /** @description runs that are computed at once; 0 where a scheduler decides */
            workers: number;
        };
        /** @description The variant whose gains are saved, and the name of the profile. */
        SweepProfile: {
            name: string;
            variant: number;
        };
        /** @description A run of a variant. */
        SweepRunDetail: {
            figures: {
                [key: string]: number | null;
            };
            number: number;
            reason: string;
            /** @description that it took */
            seconds: number;
            seed: number;
            /** @description the session that was recorded of it; null without one */
            session: number | null;
            /** @enum {string} */
            state: "complete" | "failed";
            values: (number | string)[];
            variant: number;
        };
        /** @description The sweep that was started. */
        SweepStarted: {
            sweep: number;
        };
        /** @description A sweep in the list. */
        SweepSummary: {
            best: components["schemas"]["SweepBest"] | null;
            best_figure: string;
            done: number;
            ended: number | null;
            failed: number;
            id: number;
            made: number;
            name: string;
            /** @description names */
            parameters: string[];
            /** @description why it failed, or what it waits for; empty otherwise */
            problem: string;
            /** @description s; null where not known */
            remaining: number | null;
            runs: number;
            scenario: string;
            started: number | null;
            /** @enum {string} */
            state: "running" | "waiting" | "complete" | "cancelled" | "failed" | "interrupted";
            title: string;
            who: string;
            /** @description runs that are computed at once; 0 while it does not run */
            workers: number;
        };
        /** @description A sweep to begin with. */
        SweepTemplate: {
            /** @description TOML */
            text: string;
        };
        /** @description A variant: its values in the order of the parameters, null where each seed draws its own. */
        SweepVariant: {
            failed: number;
            figures: {
                [key: string]: components["schemas"]["FigureInterval"];
            };
            number: number;
            runs: number;
            values: (number | string | null)[];
            /** @description all limits are kept */
            within: boolean;
        };
        /** @description The track from an arming to the disarming. */
        SwumTrack: {
            /** @description m, standard deviations of the last x and y */
            deviation: [
                number,
                number
            ];
            /** @description by dead reckoning: its error grows */
            estimate: components["schemas"]["Way"];
            /** @description null where it was not simulated */
            truth: components["schemas"]["Way"] | null;
        };
        /** @description One entry of the thesis's tables. */
        TableCell: {
            arduino_delay: number;
            baud: number;
            pi_delay: number;
            /** @description share of the numbers that arrived right */
            rate: number;
        };
        /** @description A snapshot that has just been stored. */
        TakenSnapshot: {
            /** @description the session that keeps it */
            session: number;
            /** @description s since the session's start */
            time: number;
        };
        /** @description A shipped test document. */
        TestDocument: {
            name: string;
            text: string;
            title: string;
        };
        /** @description One of the thesis's tables. */
        ThesisTable: {
            cells: components["schemas"]["TableCell"][];
            framing: string;
            /** @enum {string} */
            name: "table5" | "table6";
            title: string;
        };
        /** @description A time range, s on the common time axis, where the aligned moment is 0. */
        TimeRange: {
            end: number;
            start: number;
        };
        /** @description A session as a whole, for its seek bar. */
        Timeline: {
            /** @description s, up to the last samples that are stored */
            duration: number;
            /** @description in order of time, the first 2000 */
            events: components["schemas"]["Moment"][];
            /** @description whether there are pictures of a film */
            filmed: boolean;
            /** @description in order of time, the first 2000 */
            holes: components["schemas"]["StateSilence"][];
            /** @description in order of time, the first 2000 */
            markers: components["schemas"]["Bookmark"][];
            name: string;
            /**
             * Format: date-time
             * @description UTC
             */
            started: string;
            /** @description the same moment on the steady clock of its samples, s */
            started_steady: number;
            /** @enum {string} */
            state: "recording" | "complete" | "interrupted";
        };
        /** @description A mission to try, once for each seed from 1 on. */
        TrialStart: {
            seeds?: number;
            /** @description TOML */
            text: string;
        };
        /** @description Something that may be tuned while the robot runs, and its value. */
        TunableParameter: {
            choices: string[];
            default: number | string | boolean;
            maximum: number | null;
            meaning: string;
            minimum: number | null;
            name: string;
            pending: boolean;
            /** @enum {string} */
            type: "number" | "whole" | "choice" | "switch";
            unit: string;
            value: number | string | boolean;
            /** @enum {string} */
            where: "runtime" | "firmware";
            while_armed: boolean;
        };
        /**
         * @description The ticks of a loop, in order: times in s, values in the loop's unit (m, rad), outputs -1 to 1.
         *
         *     Times of a stored curve count from the step, or from when the relay took over.
         */
        TuningCurve: {
            outputs: number[];
            set_points: number[];
            times: number[];
            values: number[];
        };
        /** @description A run's new name. */
        TuningName: {
            name: string;
        };
        /** @description A run, without its curve. */
        TuningRun: {
            /** @description of a relay experiment */
            cycle: components["schemas"]["MeasuredLimitCycle"] | null;
            /** @description of a step response, by name */
            figures: {
                [key: string]: components["schemas"]["Figure"];
            };
            force: components["schemas"]["ControllerInForce"];
            id: number;
            /** @enum {string} */
            kind: "step" | "relay";
            /** @enum {string} */
            loop: "depth" | "heading" | "pitch" | "roll";
            name: string;
            /** @description why it did not complete */
            problem: string;
            /** @description the request that started it */
            settings: {
                [key: string]: unknown;
            };
            /** Format: date-time */
            started: string;
            /** @enum {string} */
            state: "running" | "complete" | "stopped" | "failed" | "interrupted";
        };
        /** @description A run with its curve and proposals. */
        TuningRunDetail: {
            curve: components["schemas"]["TuningCurve"];
            /** @description of a relay experiment */
            cycle: components["schemas"]["MeasuredLimitCycle"] | null;
            /** @description of a step response, by name */
            figures: {
                [key: string]: components["schemas"]["Figure"];
            };
            force: components["schemas"]["ControllerInForce"];
            id: number;
            /** @enum {string} */
            kind: "step" | "relay";
            /** @enum {string} */
            loop: "depth" | "heading" | "pitch" | "roll";
            name: string;
            /** @description why it did not complete */
            problem: string;
            /** @description of a relay experiment: gains of a PID by several rules */
            proposals: components["schemas"]["Proposal"][];
            /** @description the request that started it */
            settings: {
                [key: string]: unknown;
            };
            /** Format: date-time */
            started: string;
            /** @enum {string} */
            state: "running" | "complete" | "stopped" | "failed" | "interrupted";
        };
        /** @description The runs on a loop, newest first, and the meanings of their figures. */
        TuningRuns: {
            figures: components["schemas"]["FigureMeaning"][];
            runs: components["schemas"]["TuningRun"][];
        };
        /** @description The number of the started run. */
        TuningStarted: {
            run: number;
        };
        /** @description The active run, and the last one since the server's start. */
        TuningState: {
            active: components["schemas"]["ActiveTuning"] | null;
            last: components["schemas"]["TuningRun"] | null;
        };
        /** @description The change to undo: the newest that is not undone. */
        Undo: {
            change: number;
        };
        /** @description The versions on the robot's computer, and the present or last update or way back. */
        UpdateState: {
            /** @description as services, which can be updated from a page */
            installed: boolean;
            /**
             * @description since the computer's start; asked: it is about to begin
             * @enum {string}
             */
            phase: "none" | "asked" | "running" | "done" | "failed";
            /** @description the one that `mucat rollback` goes back to; empty without one */
            previous: string;
            /** @description why none can be begun from a page now; empty if one can */
            refusal: string;
            /** @description what is being done, or how it ended */
            text: string;
            /** @description of the text */
            time: string | null;
            /** @description in use */
            version: string;
        };
        /** @description The firmware to upload: the one built with this software, or the previous one. */
        UploadOrder: {
            /** @enum {string} */
            firmware: "built" | "previous";
        };
        /** @description The present or last upload of firmware. */
        UploadState: {
            /**
             * @description reading: the firmware that is on the board is being read
             * @enum {string}
             */
            phase: "idle" | "reading" | "uploading";
            previous: components["schemas"]["PreviousFirmware"] | null;
            /** @description why it failed, and what to do; empty if it did not */
            problem: string;
            /** @description 0 to 1, of the phase; an upload is written, then verified */
            progress: number;
            /** @description how the last one ended */
            words: string;
        };
        /** @description All settings, and those at the beginning of the editing. */
        VisionEdit: {
            /** @description refused if others are in force by now; null replaces any */
            base?: components["schemas"]["VisionSettingsCommand"] | null;
            settings: components["schemas"]["VisionSettingsCommand"];
        };
        /**
         * @description Rate in Hz; areas as shares of the picture, `opening` as a share of its width.
         *
         *     `colour` is the target colour, whose mask is shown. A patch counts if its area, its fill (area over that
         *     of its upright box), its aspect (the box's width over height) and its circularity (4π·area over
         *     perimeter²; 1: a circle) lie within these limits. Without `marker_numbers` every marker of the dictionary
         *     counts. `actions` are set points (m) while a colour or `marker 7` is seen. With `confirmation` (2, 3) it
         *     is seen while at least 2 of the last 3 pictures show it. The picture is turned clockwise by `turn` °,
         *     then mirrored left to right. `exposure` (ms), `gain` and `colour_temperature` (K) fix what a Pi or USB
         *     camera else chooses by itself; 0 leaves it to the camera. Raises ConfigError on settings that contradict
         *     each other.
         */
        VisionSettings: {
            actions: {
                [key: string]: number;
            };
            /** @default 1 */
            area_max: number;
            /** @default 0.01 */
            area_min: number;
            /**
             * @default [
             *       0.05,
             *       20
             *     ]
             */
            aspect: [
                number,
                number
            ];
            /** @default 0 */
            circularity_min: number;
            /** @default yellow */
            colour: string;
            /** @default 0 */
            colour_temperature: number;
            colours: {
                [key: string]: components["schemas"]["ColourRange-Output"];
            };
            /**
             * @default [
             *       2,
             *       3
             *     ]
             */
            confirmation: [
                number,
                number
            ];
            /** @default 0 */
            exposure: number;
            /** @default 0 */
            fill_min: number;
            /** @default 0 */
            gain: number;
            /** @default [] */
            marker_numbers: number[];
            /**
             * @default none
             * @enum {string}
             */
            markers: "none" | "4x4_50" | "5x5_100" | "6x6_250" | "7x7_1000" | "original" | "april_36h11";
            /** @default false */
            mirror: boolean;
            /** @default 0.01 */
            opening: number;
            /** @default 4 */
            rate: number;
            /**
             * @default 0
             * @enum {integer}
             */
            turn: 0 | 90 | 180 | 270;
            /**
             * @default none
             * @enum {string}
             */
            white_balance: "none" | "grey_world" | "underwater";
        };
        /**
         * @description Replaces all settings of the vision node, also for later starts.
         *
         *     A setting that version 0.2 did not have stays if it is left out. No other may be left out.
         */
        VisionSettingsCommand: {
            actions: {
                [key: string]: number;
            };
            area_max: number;
            area_min: number;
            aspect: [
                number,
                number
            ];
            circularity_min: number;
            colour: string;
            colour_temperature?: number | null;
            colours: {
                [key: string]: components["schemas"]["ColourRange-Input"];
            };
            confirmation?: [
                number,
                number
            ] | null;
            exposure?: number | null;
            fill_min: number;
            gain?: number | null;
            marker_numbers: number[];
            /** @enum {string} */
            markers: "none" | "4x4_50" | "5x5_100" | "6x6_250" | "7x7_1000" | "original" | "april_36h11";
            mirror?: boolean | null;
            opening: number;
            rate: number;
            turn?: (0 | 90 | 180 | 270) | null;
            /** @enum {string} */
            white_balance: "none" | "grey_world" | "underwater";
        };
        /** @description The settings now, and those of robot.toml. */
        VisionSetup: {
            configured: components["schemas"]["VisionSettings"];
            settings: components["schemas"]["VisionSettings"];
        };
        /** @description robot.toml, or a piece of it with the table [vision]. */
        VisionText: {
            text: string;
        };
        /** @description Points of a track, in order of time. */
        Way: {
            /** @description m */
            depth: number[];
            /** @description s since the session's start */
            time: number[];
            /** @description m, along heading 0 */
            x: number[];
            /** @description m, along heading 90° */
            y: number[];
        };
        /** @description Sets the surface's pressure to the pressure now. It is refused while the robot is armed. */
        ZeroDepthCommand: Record<string, never>;
    };
    responses: never;
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type AcknowledgeCommand = components['schemas']['AcknowledgeCommand'];
export type ActiveIdentification = components['schemas']['ActiveIdentification'];
export type ActiveRun = components['schemas']['ActiveRun'];
export type ActiveTuning = components['schemas']['ActiveTuning'];
export type AdoptedCraft = components['schemas']['AdoptedCraft'];
export type Alarm = components['schemas']['Alarm'];
export type Align = components['schemas']['Align'];
export type ArchivedSessions = components['schemas']['ArchivedSessions'];
export type ArmCommand = components['schemas']['ArmCommand'];
export type AuditEntry = components['schemas']['AuditEntry'];
export type AuditList = components['schemas']['AuditList'];
export type BeaconLevels = components['schemas']['BeaconLevels'];
export type BenchHands = components['schemas']['BenchHands'];
export type Bookmark = components['schemas']['Bookmark'];
export type BookmarkChanges = components['schemas']['BookmarkChanges'];
export type BringUpAction = components['schemas']['BringUpAction'];
export type BringUpOrder = components['schemas']['BringUpOrder'];
export type BringUpQuestion = components['schemas']['BringUpQuestion'];
export type BringUpResult = components['schemas']['BringUpResult'];
export type BringUpState = components['schemas']['BringUpState'];
export type BringUpStep = components['schemas']['BringUpStep'];
export type CalibrateCommand = components['schemas']['CalibrateCommand'];
export type CalibrationValues = components['schemas']['CalibrationValues'];
export type CallerDetails = components['schemas']['CallerDetails'];
export type CardCommand = components['schemas']['CardCommand'];
export type Cell = components['schemas']['Cell'];
export type Change = components['schemas']['Change'];
export type ChangedValue = components['schemas']['ChangedValue'];
export type Check = components['schemas']['Check'];
export type CheckFinsCommand = components['schemas']['CheckFinsCommand'];
export type CheckedSession = components['schemas']['CheckedSession'];
export type CheckedTest = components['schemas']['CheckedTest'];
export type ColourRangeInput = components['schemas']['ColourRange-Input'];
export type ColourRangeOutput = components['schemas']['ColourRange-Output'];
export type CommTestRunDetails = components['schemas']['CommTestRunDetails'];
export type CommTestStart = components['schemas']['CommTestStart'];
export type Compared = components['schemas']['Compared'];
export type Comparison = components['schemas']['Comparison'];
export type ComparisonQuery = components['schemas']['ComparisonQuery'];
export type Confirmation = components['schemas']['Confirmation'];
export type ControlDetails = components['schemas']['ControlDetails'];
export type ControlState = components['schemas']['ControlState'];
export type ControllerChoice = components['schemas']['ControllerChoice'];
export type ControllerInForce = components['schemas']['ControllerInForce'];
export type CraftChange = components['schemas']['CraftChange'];
export type DeviceChanges = components['schemas']['DeviceChanges'];
export type DeviceDetails = components['schemas']['DeviceDetails'];
export type Difference = components['schemas']['Difference'];
export type Dissection = components['schemas']['Dissection'];
export type DocumentText = components['schemas']['DocumentText'];
export type DoorClientDetails = components['schemas']['DoorClientDetails'];
export type DoorDetails = components['schemas']['DoorDetails'];
export type DriveCounts = components['schemas']['DriveCounts'];
export type EncoderReading = components['schemas']['EncoderReading'];
export type EndedIdentification = components['schemas']['EndedIdentification'];
export type EndedRun = components['schemas']['EndedRun'];
export type EntryProblem = components['schemas']['EntryProblem'];
export type EstimatedPosition = components['schemas']['EstimatedPosition'];
export type EventField = components['schemas']['EventField'];
export type ExportOptions = components['schemas']['ExportOptions'];
export type FailureCount = components['schemas']['FailureCount'];
export type Figure = components['schemas']['Figure'];
export type FigureExample = components['schemas']['FigureExample'];
export type FigureGroup = components['schemas']['FigureGroup'];
export type FigureInterval = components['schemas']['FigureInterval'];
export type FigureMark = components['schemas']['FigureMark'];
export type FigureMeaning = components['schemas']['FigureMeaning'];
export type FigurePeriod = components['schemas']['FigurePeriod'];
export type FigureStudy = components['schemas']['FigureStudy'];
export type FilmDescription = components['schemas']['FilmDescription'];
export type FilmOrder = components['schemas']['FilmOrder'];
export type FilmPlan = components['schemas']['FilmPlan'];
export type FilmSpan = components['schemas']['FilmSpan'];
export type FinReading = components['schemas']['FinReading'];
export type FinTurn = components['schemas']['FinTurn'];
export type Finding = components['schemas']['Finding'];
export type FittedSession = components['schemas']['FittedSession'];
export type Flag = components['schemas']['Flag'];
export type Gain = components['schemas']['Gain'];
export type HandsOrder = components['schemas']['HandsOrder'];
export type Health = components['schemas']['Health'];
export type Holder = components['schemas']['Holder'];
export type IdentificationResult = components['schemas']['IdentificationResult'];
export type IdentificationStart = components['schemas']['IdentificationStart'];
export type IdentificationStarted = components['schemas']['IdentificationStarted'];
export type IdentificationState = components['schemas']['IdentificationState'];
export type IdentifiedNumber = components['schemas']['IdentifiedNumber'];
export type Identity = components['schemas']['Identity'];
export type Imported = components['schemas']['Imported'];
export type ImuRaw = components['schemas']['ImuRaw'];
export type IssuedMembership = components['schemas']['IssuedMembership'];
export type Job = components['schemas']['Job'];
export type Joining = components['schemas']['Joining'];
export type JoiningRobot = components['schemas']['JoiningRobot'];
export type JsonValue = components['schemas']['JsonValue'];
export type LabMembership = components['schemas']['LabMembership'];
export type LayoutDetails = components['schemas']['LayoutDetails'];
export type LayoutDocument = components['schemas']['LayoutDocument'];
export type LeftLab = components['schemas']['LeftLab'];
export type LeftOut = components['schemas']['LeftOut'];
export type Likeness = components['schemas']['Likeness'];
export type Lines = components['schemas']['Lines'];
export type LinesQuery = components['schemas']['LinesQuery'];
export type LinkFault = components['schemas']['LinkFault'];
export type LinkFrames = components['schemas']['LinkFrames'];
export type LiveTopic = components['schemas']['LiveTopic'];
export type LiveTopicField = components['schemas']['LiveTopicField'];
export type Loop = components['schemas']['Loop'];
export type LoopCommand = components['schemas']['LoopCommand'];
export type MadeCode = components['schemas']['MadeCode'];
export type MadeJoiningCode = components['schemas']['MadeJoiningCode'];
export type MadeReadingLink = components['schemas']['MadeReadingLink'];
export type MadeToken = components['schemas']['MadeToken'];
export type MeasureGyroCommand = components['schemas']['MeasureGyroCommand'];
export type MeasuredLimitCycle = components['schemas']['MeasuredLimitCycle'];
export type Mission = components['schemas']['Mission'];
export type MissionBody = components['schemas']['MissionBody'];
export type MissionCheck = components['schemas']['MissionCheck'];
export type MissionEndCommand = components['schemas']['MissionEndCommand'];
export type MissionNodeKind = components['schemas']['MissionNodeKind'];
export type MissionPauseCommand = components['schemas']['MissionPauseCommand'];
export type MissionPlanned = components['schemas']['MissionPlanned'];
export type MissionSkipCommand = components['schemas']['MissionSkipCommand'];
export type MissionStepStart = components['schemas']['MissionStepStart'];
export type MissionStepState = components['schemas']['MissionStepState'];
export type MissionStepSummary = components['schemas']['MissionStepSummary'];
export type MissionSummary = components['schemas']['MissionSummary'];
export type MissionText = components['schemas']['MissionText'];
export type MissionTrial = components['schemas']['MissionTrial'];
export type MissionTrialResult = components['schemas']['MissionTrialResult'];
export type MissionVersion = components['schemas']['MissionVersion'];
export type ModeCommand = components['schemas']['ModeCommand'];
export type Moment = components['schemas']['Moment'];
export type NewBookmark = components['schemas']['NewBookmark'];
export type NewCode = components['schemas']['NewCode'];
export type NewExport = components['schemas']['NewExport'];
export type NewLayout = components['schemas']['NewLayout'];
export type NewMission = components['schemas']['NewMission'];
export type NewProfile = components['schemas']['NewProfile'];
export type NewReadingLink = components['schemas']['NewReadingLink'];
export type NewScenario = components['schemas']['NewScenario'];
export type NewSession = components['schemas']['NewSession'];
export type NewToken = components['schemas']['NewToken'];
export type NextBest = components['schemas']['NextBest'];
export type NodeField = components['schemas']['NodeField'];
export type OwnPanel = components['schemas']['OwnPanel'];
export type OwnPanelScript = components['schemas']['OwnPanelScript'];
export type Pace = components['schemas']['Pace'];
export type Paired = components['schemas']['Paired'];
export type Pairing = components['schemas']['Pairing'];
export type Parameters = components['schemas']['Parameters'];
export type ParametersCommand = components['schemas']['ParametersCommand'];
export type PartHealth = components['schemas']['PartHealth'];
export type PastMissionRun = components['schemas']['PastMissionRun'];
export type PickPlace = components['schemas']['PickPlace'];
export type PickedColour = components['schemas']['PickedColour'];
export type PictureBytes = components['schemas']['PictureBytes'];
export type PlacedPanel = components['schemas']['PlacedPanel'];
export type PlannedMissionStep = components['schemas']['PlannedMissionStep'];
export type PredictedChannel = components['schemas']['PredictedChannel'];
export type PredictedStep = components['schemas']['PredictedStep'];
export type PredictionQuery = components['schemas']['PredictionQuery'];
export type Presence = components['schemas']['Presence'];
export type PresentAlarm = components['schemas']['PresentAlarm'];
export type PresentMission = components['schemas']['PresentMission'];
export type PreviousFirmware = components['schemas']['PreviousFirmware'];
export type Problem = components['schemas']['Problem'];
export type Profile = components['schemas']['Profile'];
export type ProfileText = components['schemas']['ProfileText'];
export type Proposal = components['schemas']['Proposal'];
export type QueuedRun = components['schemas']['QueuedRun'];
export type RankedBest = components['schemas']['RankedBest'];
export type RawReadings = components['schemas']['RawReadings'];
export type ReadingLink = components['schemas']['ReadingLink'];
export type ReadingToken = components['schemas']['ReadingToken'];
export type Readings = components['schemas']['Readings'];
export type RecordedColumn = components['schemas']['RecordedColumn'];
export type RecordedCraft = components['schemas']['RecordedCraft'];
export type RecordedMission = components['schemas']['RecordedMission'];
export type RecordedTopic = components['schemas']['RecordedTopic'];
export type RelayStart = components['schemas']['RelayStart'];
export type Restored = components['schemas']['Restored'];
export type RobotPull = components['schemas']['RobotPull'];
export type RosterDetails = components['schemas']['RosterDetails'];
export type RosterRobot = components['schemas']['RosterRobot'];
export type RunSummary = components['schemas']['RunSummary'];
export type SavedLayout = components['schemas']['SavedLayout'];
export type ScenarioCheck = components['schemas']['ScenarioCheck'];
export type ScenarioDocument = components['schemas']['ScenarioDocument'];
export type ScenarioEvent = components['schemas']['ScenarioEvent'];
export type ScenarioEventKind = components['schemas']['ScenarioEventKind'];
export type ScenarioStart = components['schemas']['ScenarioStart'];
export type ScenarioStarted = components['schemas']['ScenarioStarted'];
export type ScenarioState = components['schemas']['ScenarioState'];
export type ScenarioSummary = components['schemas']['ScenarioSummary'];
export type ScenarioText = components['schemas']['ScenarioText'];
export type SceneView = components['schemas']['SceneView'];
export type Segment = components['schemas']['Segment'];
export type SegmentChoice = components['schemas']['SegmentChoice'];
export type Session = components['schemas']['Session'];
export type SessionBase = components['schemas']['SessionBase'];
export type SessionChanges = components['schemas']['SessionChanges'];
export type SessionDetail = components['schemas']['SessionDetail'];
export type SessionEdits = components['schemas']['SessionEdits'];
export type SessionGap = components['schemas']['SessionGap'];
export type SessionGroup = components['schemas']['SessionGroup'];
export type SessionLines = components['schemas']['SessionLines'];
export type SessionRun = components['schemas']['SessionRun'];
export type SessionSummary = components['schemas']['SessionSummary'];
export type ShownChart = components['schemas']['ShownChart'];
export type Signal = components['schemas']['Signal'];
export type SignalLine = components['schemas']['SignalLine'];
export type SignalPair = components['schemas']['SignalPair'];
export type SimulatorPlace = components['schemas']['SimulatorPlace'];
export type SnapshotValues = components['schemas']['SnapshotValues'];
export type Spectrum = components['schemas']['Spectrum'];
export type SpectrumPeak = components['schemas']['SpectrumPeak'];
export type Started = components['schemas']['Started'];
export type State = components['schemas']['State'];
export type StateSilence = components['schemas']['StateSilence'];
export type SteeringCommand = components['schemas']['SteeringCommand'];
export type StepStart = components['schemas']['StepStart'];
export type StoppedRobot = components['schemas']['StoppedRobot'];
export type Storage = components['schemas']['Storage'];
export type Story = components['schemas']['Story'];
export type StoryFigures = components['schemas']['StoryFigures'];
export type SweepBest = components['schemas']['SweepBest'];
export type SweepDetail = components['schemas']['SweepDetail'];
export type SweepDocument = components['schemas']['SweepDocument'];
export type SweepParameter = components['schemas']['SweepParameter'];
export type SweepPlan = components['schemas']['SweepPlan'];
export type SweepProfile = components['schemas']['SweepProfile'];
export type SweepRunDetail = components['schemas']['SweepRunDetail'];
export type SweepStarted = components['schemas']['SweepStarted'];
export type SweepSummary = components['schemas']['SweepSummary'];
export type SweepTemplate = components['schemas']['SweepTemplate'];
export type SweepVariant = components['schemas']['SweepVariant'];
export type SwumTrack = components['schemas']['SwumTrack'];
export type TableCell = components['schemas']['TableCell'];
export type TakenSnapshot = components['schemas']['TakenSnapshot'];
export type TestDocument = components['schemas']['TestDocument'];
export type ThesisTable = components['schemas']['ThesisTable'];
export type TimeRange = components['schemas']['TimeRange'];
export type Timeline = components['schemas']['Timeline'];
export type TrialStart = components['schemas']['TrialStart'];
export type TunableParameter = components['schemas']['TunableParameter'];
export type TuningCurve = components['schemas']['TuningCurve'];
export type TuningName = components['schemas']['TuningName'];
export type TuningRun = components['schemas']['TuningRun'];
export type TuningRunDetail = components['schemas']['TuningRunDetail'];
export type TuningRuns = components['schemas']['TuningRuns'];
export type TuningStarted = components['schemas']['TuningStarted'];
export type TuningState = components['schemas']['TuningState'];
export type Undo = components['schemas']['Undo'];
export type UpdateState = components['schemas']['UpdateState'];
export type UploadOrder = components['schemas']['UploadOrder'];
export type UploadState = components['schemas']['UploadState'];
export type VisionEdit = components['schemas']['VisionEdit'];
export type VisionSettings = components['schemas']['VisionSettings'];
export type VisionSettingsCommand = components['schemas']['VisionSettingsCommand'];
export type VisionSetup = components['schemas']['VisionSetup'];
export type VisionText = components['schemas']['VisionText'];
export type Way = components['schemas']['Way'];
export type ZeroDepthCommand = components['schemas']['ZeroDepthCommand'];
export interface operations {
    makeCode: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewCode"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["MadeCode"];
                };
            };
        };
    };
    confirmBrowser: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Confirmation"];
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    listDevices: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["DeviceDetails"][];
                };
            };
        };
    };
    revokeDevice: {
        parameters: {
            query?: never;
            path: {
                device: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    changeDevice: {
        parameters: {
            query?: never;
            path: {
                device: number;
            };
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DeviceChanges"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["DeviceDetails"];
                };
            };
        };
    };
    getMe: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["CallerDetails"];
                };
            };
        };
    };
    pairBrowser: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "code": "2345-6789",
                 *       "name": "Anna's laptop"
                 *     }
                 */
                "application/json": components["schemas"]["Pairing"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Paired"];
                };
            };
        };
    };
    openReadingLink: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ReadingToken"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Paired"];
                };
            };
        };
    };
    listReadingLinks: {
        parameters: {
            query: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ReadingLink"][];
                };
            };
        };
    };
    makeReadingLink: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewReadingLink"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["MadeReadingLink"];
                };
            };
        };
    };
    endReadingLink: {
        parameters: {
            query?: never;
            path: {
                link: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    signOut: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    makeToken: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "name": "notebook",
                 *       "scope": "operate"
                 *     }
                 */
                "application/json": components["schemas"]["NewToken"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["MadeToken"];
                };
            };
        };
    };
    checkAlive: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    listAudit: {
        parameters: {
            query?: {
                who?: string;
                what?: string;
                /** @description s since 1970 */
                since?: number | null;
                /** @description s since 1970 */
                until?: number | null;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["AuditList"];
                };
            };
        };
    };
    exportAudit: {
        parameters: {
            query?: {
                spreadsheet?: "none" | "point" | "comma";
                who?: string;
                what?: string;
                /** @description s since 1970 */
                since?: number | null;
                /** @description s since 1970 */
                until?: number | null;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "text/csv": unknown;
                };
            };
        };
    };
    downloadBackup: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/vnd.sqlite3": unknown;
                };
            };
        };
    };
    getBringUp: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["BringUpState"];
                };
            };
        };
    };
    beginBringUp: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["BringUpState"];
                };
            };
        };
    };
    endBringUp: {
        parameters: {
            query?: {
                /** @description the run that is meant: refused if it is over */
                run?: string | null;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["BringUpState"];
                };
            };
        };
    };
    actInBringUp: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["BringUpOrder"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["BringUpState"];
                };
            };
        };
    };
    useHandsInBringUp: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["HandsOrder"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["BringUpState"];
                };
            };
        };
    };
    getBringUpReport: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": unknown;
                };
            };
        };
    };
    cancelTestRun: {
        parameters: {
            query?: {
                /** @description the run that is meant: refused if it is over */
                run?: number | null;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    checkTestDocument: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["DocumentText"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Check"];
                };
            };
        };
    };
    listTestDocuments: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["TestDocument"][];
                };
            };
        };
    };
    listTestRuns: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["RunSummary"][];
                };
            };
        };
    };
    startTestRun: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CommTestStart"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["Started"];
                };
            };
        };
    };
    getTestRun: {
        parameters: {
            query?: never;
            path: {
                run: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["CommTestRunDetails"];
                };
            };
        };
    };
    downloadTestRunCsv: {
        parameters: {
            query?: {
                spreadsheet?: "none" | "point" | "comma";
            };
            path: {
                run: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "text/csv": unknown;
                };
            };
        };
    };
    downloadTestRunJson: {
        parameters: {
            query?: never;
            path: {
                run: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": unknown;
                };
            };
        };
    };
    listTestTables: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ThesisTable"][];
                };
            };
        };
    };
    compareSessions: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "sessions": [
                 *         1,
                 *         2
                 *       ],
                 *       "signals": [
                 *         "depth.depth"
                 *       ]
                 *     }
                 */
                "application/json": components["schemas"]["ComparisonQuery"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Comparison"];
                };
            };
        };
    };
    compareLines: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["LinesQuery"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Lines"];
                };
            };
        };
    };
    getComparisonReport: {
        parameters: {
            query: {
                sessions: string;
                signals?: string;
                by?: string;
                number?: number;
                marker?: string;
                step?: string;
                /** @description start of the range for the figures */
                start?: number | null;
                end?: number | null;
                over?: string;
                /** @description as “7:2,9:1”: of session 7 the second, of session 9 the first */
                segments?: string;
                /** @description start of the part that the charts show first */
                view_start?: number | null;
                view_end?: number | null;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "text/html": unknown;
                };
            };
        };
    };
    getControl: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ControlDetails"];
                };
            };
        };
    };
    releaseControl: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ControlState"];
                };
            };
        };
    };
    takeControl: {
        parameters: {
            query?: {
                over?: boolean;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ControlState"];
                };
            };
        };
    };
    getFindings: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Finding"][];
                };
            };
        };
    };
    examineAgain: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Finding"][];
                };
            };
        };
    };
    listDoors: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["DoorDetails"][];
                };
            };
        };
    };
    listExports: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Job"][];
                };
            };
        };
    };
    startExport: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "format": "csv",
                 *       "session": 1
                 *     }
                 */
                "application/json": components["schemas"]["NewExport"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["Job"];
                };
            };
        };
    };
    getExport: {
        parameters: {
            query?: never;
            path: {
                export: string;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Job"];
                };
            };
        };
    };
    deleteExport: {
        parameters: {
            query?: never;
            path: {
                export: string;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    downloadExport: {
        parameters: {
            query?: never;
            path: {
                export: string;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/octet-stream": unknown;
                };
            };
        };
    };
    getFigureStudy: {
        parameters: {
            query?: {
                /** @description words that name, notes, tags or scenario have */
                search?: string;
                /** @description tags that they have, all of them */
                tag?: string[];
                origin?: ("operator" | "arming" | "scenario" | "simulated" | "import") | null;
                state?: ("recording" | "complete" | "interrupted") | null;
                /** @description name of the scenario that they ran */
                scenario?: string;
                /** @description title of one that held the depth */
                controller?: string;
                /** @description name of the robot that recorded them */
                robot?: string;
                /** @description only those with a film */
                film?: boolean;
                /** @description only those that the rules of retention never take */
                kept?: boolean;
                /** @description started then or later */
                since?: string | null;
                /** @description started before */
                until?: string | null;
                /** @description those in the bin instead */
                deleted?: boolean;
                figure?: "duration" | "deepest" | "rmse" | "cycle_amplitude" | "overshoot" | "settling_time" | "fin_strokes" | "frames_lost" | "alarms";
                /** @description a value of each session, or of each time with one controller, gains and set point */
                of?: "session" | "segment";
                by?: "none" | "controller" | "gains" | "craft" | "firmware" | "software" | "robot";
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["FigureStudy"];
                };
            };
        };
    };
    getFilmPlan: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["FilmPlan"];
                };
            };
        };
    };
    chooseFilm: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["FilmOrder"];
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    getFirmwareUpload: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["UploadState"];
                };
            };
        };
    };
    uploadFirmware: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["UploadOrder"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["UploadState"];
                };
            };
        };
    };
    getHealth: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Health"];
                };
            };
        };
    };
    getIdentification: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["IdentificationState"];
                };
            };
        };
    };
    startIdentification: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["IdentificationStart"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["IdentificationStarted"];
                };
            };
        };
    };
    adoptCraft: {
        parameters: {
            query?: {
                /** @description the run that is meant: refused if it is over */
                run?: string | null;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["CraftChange"];
                };
            };
        };
    };
    cancelIdentification: {
        parameters: {
            query?: {
                /** @description the run that is meant: refused if it is over */
                run?: string | null;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    undoCraft: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["CraftChange"];
                };
            };
        };
    };
    importSession: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/zip": string;
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
        };
    };
    getLab: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["LabMembership"];
                };
            };
        };
    };
    leaveLab: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["LeftLab"];
                };
            };
        };
    };
    joinLab: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["Joining"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["LabMembership"];
                };
            };
        };
    };
    listPulls: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["RobotPull"][];
                };
            };
        };
    };
    listLayouts: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SavedLayout"][];
                };
            };
        };
    };
    saveLayout: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["NewLayout"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["SavedLayout"];
                };
            };
        };
    };
    getLayout: {
        parameters: {
            query?: never;
            path: {
                layout: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["LayoutDetails"];
                };
            };
        };
    };
    deleteLayout: {
        parameters: {
            query?: never;
            path: {
                layout: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    getLinkFrames: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["LinkFrames"];
                };
            };
        };
    };
    listMissions: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["MissionText"][];
                };
            };
        };
    };
    keepMission: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "text": "format = 1\nname = \"short_dive\"\ntitle = \"A short dive\"\n\n[mission]\ndo = \"sequence\"\nsteps = [\n  { do = \"dive\", depth = 0.6, timeout = 30 },\n  { do = \"surface\" },\n]\n"
                 *     }
                 */
                "application/json": components["schemas"]["NewMission"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["MissionSummary"];
                };
            };
        };
    };
    checkMission: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "text": "format = 1\nname = \"short_dive\"\ntitle = \"A short dive\"\n\n[mission]\ndo = \"sequence\"\nsteps = [\n  { do = \"dive\", depth = 0.6, timeout = 30 },\n  { do = \"surface\" },\n]\n"
                 *     }
                 */
                "application/json": components["schemas"]["MissionBody"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["MissionCheck"];
                };
            };
        };
    };
    listMissionNodes: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["MissionNodeKind"][];
                };
            };
        };
    };
    listMissionRuns: {
        parameters: {
            query?: never;
            path: {
                name: string;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["PastMissionRun"][];
                };
            };
        };
    };
    startMission: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "text": "format = 1\nname = \"short_dive\"\ntitle = \"A short dive\"\n\n[mission]\ndo = \"sequence\"\nsteps = [\n  { do = \"dive\", depth = 0.6, timeout = 30 },\n  { do = \"surface\" },\n]\n"
                 *     }
                 */
                "application/json": components["schemas"]["MissionBody"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["MissionSummary"];
                };
            };
        };
    };
    getMissionState: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Mission"] | null;
                };
            };
        };
    };
    getMissionTrial: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["MissionTrial"];
                };
            };
        };
    };
    startMissionTrial: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "seeds": 3,
                 *       "text": "format = 1\nname = \"short_dive\"\ntitle = \"A short dive\"\n\n[mission]\ndo = \"sequence\"\nsteps = [\n  { do = \"dive\", depth = 0.6, timeout = 30 },\n  { do = \"surface\" },\n]\n"
                 *     }
                 */
                "application/json": components["schemas"]["TrialStart"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["MissionTrial"];
                };
            };
        };
    };
    cancelMissionTrial: {
        parameters: {
            query?: {
                /** @description the run that is meant: refused if it is over */
                run?: string | null;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    listMissionVersions: {
        parameters: {
            query?: never;
            path: {
                name: string;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["MissionVersion"][];
                };
            };
        };
    };
    deleteMission: {
        parameters: {
            query?: never;
            path: {
                name: string;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    listPanels: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["OwnPanel"][];
                };
            };
        };
    };
    getPanelFrame: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "text/html": string;
                };
            };
        };
    };
    getPanel: {
        parameters: {
            query?: never;
            path: {
                panel: string;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["OwnPanelScript"];
                };
            };
        };
    };
    getParameters: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Parameters"];
                };
            };
        };
    };
    listParameterChanges: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Change"][];
                };
            };
        };
    };
    undoParameters: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "change": 3
                 *     }
                 */
                "application/json": components["schemas"]["Undo"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Restored"];
                };
            };
        };
    };
    getPast: {
        parameters: {
            query: {
                /** @description of rows; may be given several times */
                topic: string[];
                /** @description s, steady clock; a little more may come */
                until: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/octet-stream": unknown;
                };
            };
        };
    };
    listProfiles: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Profile"][];
                };
            };
        };
    };
    saveProfile: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "name": "calm water"
                 *     }
                 */
                "application/json": components["schemas"]["NewProfile"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["Profile"];
                };
            };
        };
    };
    importProfile: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ProfileText"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["Imported"];
                };
            };
        };
    };
    deleteProfile: {
        parameters: {
            query?: never;
            path: {
                profile: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    downloadProfile: {
        parameters: {
            query?: never;
            path: {
                profile: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": unknown;
                };
            };
        };
    };
    restoreProfile: {
        parameters: {
            query?: never;
            path: {
                profile: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Restored"];
                };
            };
        };
    };
    getRobot: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["State"];
                };
            };
        };
    };
    commandAcknowledge: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["AcknowledgeCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandArm: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                /**
                 * @example {
                 *       "mode": "manual"
                 *     }
                 */
                "application/json": components["schemas"]["ArmCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandCalibrate: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["CalibrateCommand"];
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandCard: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                /**
                 * @example {
                 *       "colour": "yellow"
                 *     }
                 */
                "application/json": components["schemas"]["CardCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandCheckFins: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["CheckFinsCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandLoop: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "gains": {
                 *         "kp": 4
                 *       },
                 *       "name": "depth",
                 *       "set_point": 0.8
                 *     }
                 */
                "application/json": components["schemas"]["LoopCommand"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Restored"];
                };
            };
        };
    };
    commandMeasureGyro: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["MeasureGyroCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandMissionEnd: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["MissionEndCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandMissionPause: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["MissionPauseCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandMissionSkip: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["MissionSkipCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandMode: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "mode": "automatic"
                 *     }
                 */
                "application/json": components["schemas"]["ModeCommand"];
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    commandParameters: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "values": {
                 *         "depth.pid.kp": 4
                 *       }
                 *     }
                 */
                "application/json": components["schemas"]["ParametersCommand"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Restored"];
                };
            };
        };
    };
    commandSteering: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "by": "beacons"
                 *     }
                 */
                "application/json": components["schemas"]["SteeringCommand"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Restored"];
                };
            };
        };
    };
    commandVisionSettings: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["VisionSettingsCommand"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Restored"];
                };
            };
        };
    };
    commandZeroDepth: {
        parameters: { query?: never };
        requestBody?: {
            content: {
                "application/json": components["schemas"]["ZeroDepthCommand"] | null;
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    stopRobot: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    listRobots: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["RosterDetails"];
                };
            };
        };
    };
    makeJoiningCode: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["MadeJoiningCode"];
                };
            };
        };
    };
    joinRobot: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["JoiningRobot"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["IssuedMembership"];
                };
            };
        };
    };
    stopAllRobots: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["StoppedRobot"][];
                };
            };
        };
    };
    removeRobot: {
        parameters: {
            query?: never;
            path: {
                robot: string;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    listScenarios: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ScenarioText"][];
                };
            };
        };
    };
    keepScenario: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "text": "name = \"short\"\ntitle = \"A short run\"\nduration = 10\n\n[scene]\nkind = \"pool\"\ndepth = 3.0\nlength = 10.0\nwidth = 5.0\n\n[[events]]\nat = 1\ndo = \"arm\"\n"
                 *     }
                 */
                "application/json": components["schemas"]["NewScenario"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["ScenarioSummary"];
                };
            };
        };
    };
    cancelScenario: {
        parameters: {
            query?: {
                /** @description the run that is meant: refused if it is over */
                run?: string | null;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    checkScenario: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "text": "name = \"short\"\ntitle = \"A short run\"\nduration = 10\n\n[scene]\nkind = \"pool\"\ndepth = 3.0\nlength = 10.0\nwidth = 5.0\n\n[[events]]\nat = 1\ndo = \"arm\"\n"
                 *     }
                 */
                "application/json": components["schemas"]["ScenarioDocument"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ScenarioCheck"];
                };
            };
        };
    };
    listScenarioEvents: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ScenarioEventKind"][];
                };
            };
        };
    };
    startScenario: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "board": "host",
                 *       "place": "simulated",
                 *       "text": "name = \"short\"\ntitle = \"A short run\"\nduration = 10\n\n[scene]\nkind = \"pool\"\ndepth = 3.0\nlength = 10.0\nwidth = 5.0\n\n[[events]]\nat = 1\ndo = \"arm\"\n"
                 *     }
                 */
                "application/json": components["schemas"]["ScenarioStart"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["ScenarioStarted"];
                };
            };
        };
    };
    getScenarioState: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["ScenarioState"];
                };
            };
        };
    };
    putView: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SceneView"];
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    listSessions: {
        parameters: {
            query?: {
                /** @description words that name, notes, tags or scenario have */
                search?: string;
                /** @description tags that they have, all of them */
                tag?: string[];
                origin?: ("operator" | "arming" | "scenario" | "simulated" | "import") | null;
                state?: ("recording" | "complete" | "interrupted") | null;
                /** @description name of the scenario that they ran */
                scenario?: string;
                /** @description title of one that held the depth */
                controller?: string;
                /** @description name of the robot that recorded them */
                robot?: string;
                /** @description only those with a film */
                film?: boolean;
                /** @description only those that the rules of retention never take */
                kept?: boolean;
                /** @description started then or later */
                since?: string | null;
                /** @description started before */
                until?: string | null;
                /** @description those in the bin instead */
                deleted?: boolean;
                by?: "none" | "day" | "scenario" | "mission";
                /** @description only sessions of lower numbers */
                before?: number | null;
                /** @description sessions that are left out before the answer */
                skip?: number;
                /** @description sessions in the answer */
                limit?: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Session"][];
                };
            };
        };
    };
    startSession: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "name": "Dive 7",
                 *       "note": "calm water"
                 *     }
                 */
                "application/json": components["schemas"]["NewSession"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
        };
    };
    noteArchived: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["ArchivedSessions"];
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    listSessionControllers: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": string[];
                };
            };
        };
    };
    listSessionEdits: {
        parameters: {
            query?: {
                before?: number | null;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SessionEdits"][];
                };
            };
        };
    };
    listSessionGroups: {
        parameters: {
            query: {
                /** @description words that name, notes, tags or scenario have */
                search?: string;
                /** @description tags that they have, all of them */
                tag?: string[];
                origin?: ("operator" | "arming" | "scenario" | "simulated" | "import") | null;
                state?: ("recording" | "complete" | "interrupted") | null;
                /** @description name of the scenario that they ran */
                scenario?: string;
                /** @description title of one that held the depth */
                controller?: string;
                /** @description name of the robot that recorded them */
                robot?: string;
                /** @description only those with a film */
                film?: boolean;
                /** @description only those that the rules of retention never take */
                kept?: boolean;
                /** @description started then or later */
                since?: string | null;
                /** @description started before */
                until?: string | null;
                /** @description those in the bin instead */
                deleted?: boolean;
                by: "none" | "day" | "scenario" | "mission";
                /** @description whose days, such as Europe/Tallinn */
                zone?: string;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SessionGroup"][];
                };
            };
        };
    };
    listSessionRobots: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": string[];
                };
            };
        };
    };
    getSession: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SessionDetail"];
                };
            };
        };
    };
    deleteSession: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
        };
    };
    changeSession: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "tags": [
                 *         "calm",
                 *         "pid"
                 *       ]
                 *     }
                 */
                "application/json": components["schemas"]["SessionChanges"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
        };
    };
    getBlocks: {
        parameters: {
            query: {
                start: number;
                end: number;
                history?: number | null;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/octet-stream": unknown;
                };
            };
        };
    };
    getFilm: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["FilmDescription"];
                };
            };
        };
    };
    getFilmPart: {
        parameters: {
            query: {
                /** @description s since the start */
                start: number;
                seconds?: number;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "video/mp4": unknown;
                };
            };
        };
    };
    addMark: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "text": "here it turned"
                 *     }
                 */
                "application/json": components["schemas"]["NewBookmark"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["Bookmark"];
                };
            };
        };
    };
    removeMark: {
        parameters: {
            query?: never;
            path: {
                session: number;
                mark: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    changeMark: {
        parameters: {
            query?: never;
            path: {
                session: number;
                mark: number;
            };
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["BookmarkChanges"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Bookmark"];
                };
            };
        };
    };
    listSessionMissions: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["RecordedMission"][];
                };
            };
        };
    };
    getPair: {
        parameters: {
            query: {
                x: string;
                y: string;
                /** @description start of the part, s since the start */
                from?: number | null;
                /** @description end of the part, s since the start */
                to?: number | null;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SignalPair"];
                };
            };
        };
    };
    purgeSession: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    getReadings: {
        parameters: {
            query: {
                /** @description s since the start */
                time: number;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Readings"];
                };
            };
        };
    };
    restoreSession: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
        };
    };
    listSignals: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Signal"][];
                };
            };
        };
    };
    getSnapshot: {
        parameters: {
            query: {
                /** @description s since the start */
                time: number;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "image/jpeg": unknown;
                };
            };
        };
    };
    listSessionSnapshots: {
        parameters: {
            query?: {
                /** @description s since the start */
                after?: number;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SnapshotValues"][];
                };
            };
        };
    };
    getSpectrum: {
        parameters: {
            query: {
                /** @description by name */
                signal: string[];
                /** @description start of the part, s since the start */
                from?: number | null;
                /** @description end of the part, s since the start */
                to?: number | null;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Spectrum"][];
                };
            };
        };
    };
    stopSession: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Session"];
                };
            };
        };
    };
    getStory: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Story"];
                };
            };
        };
    };
    getStoryFigures: {
        parameters: {
            query?: {
                /** @description start of the part, s since the start */
                from?: number | null;
                /** @description end of the part, s since the start */
                to?: number | null;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["StoryFigures"];
                };
            };
        };
    };
    getThumbnail: {
        parameters: {
            query: {
                /** @description s since the start */
                time: number;
            };
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "image/jpeg": unknown;
                };
            };
        };
    };
    getTimeline: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Timeline"];
                };
            };
        };
    };
    getTrack: {
        parameters: {
            query?: never;
            path: {
                session: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SwumTrack"][];
                };
            };
        };
    };
    putSimulator: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SimulatorPlace"];
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    takeSnapshot: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["TakenSnapshot"];
                };
            };
        };
    };
    getStorage: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["Storage"];
                };
            };
        };
    };
    listSweeps: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SweepSummary"][];
                };
            };
        };
    };
    startSweep: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SweepDocument"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["SweepStarted"];
                };
            };
        };
    };
    checkSweep: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SweepDocument"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SweepPlan"];
                };
            };
        };
    };
    getSweepTemplate: {
        parameters: {
            query: {
                scenario: string;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SweepTemplate"];
                };
            };
        };
    };
    getSweep: {
        parameters: {
            query?: never;
            path: {
                sweep: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SweepDetail"];
                };
            };
        };
    };
    deleteSweep: {
        parameters: {
            query?: never;
            path: {
                sweep: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    cancelSweep: {
        parameters: {
            query?: never;
            path: {
                sweep: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    saveSweepProfile: {
        parameters: {
            query?: never;
            path: {
                sweep: number;
            };
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["SweepProfile"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["Profile"];
                };
            };
        };
    };
    resumeSweep: {
        parameters: {
            query?: never;
            path: {
                sweep: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    listSweepRuns: {
        parameters: {
            query?: {
                /** @description of this variant alone */
                variant?: number | null;
            };
            path: {
                sweep: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["SweepRunDetail"][];
                };
            };
        };
    };
    recordSweepRun: {
        parameters: {
            query?: never;
            path: {
                sweep: number;
                run: number;
            };
        };
        requestBody?: never;
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["SessionRun"];
                };
            };
        };
    };
    downloadSweepTable: {
        parameters: {
            query?: never;
            path: {
                sweep: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "text/csv": unknown;
                };
            };
        };
    };
    listTags: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": string[];
                };
            };
        };
    };
    listTopics: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["LiveTopic"][];
                };
            };
        };
    };
    predictStep: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["PredictionQuery"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["PredictedStep"];
                };
            };
        };
    };
    listTuningRuns: {
        parameters: {
            query?: {
                loop?: "depth" | "heading" | "pitch" | "roll";
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["TuningRuns"];
                };
            };
        };
    };
    startTuningRun: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["StepStart"] | components["schemas"]["RelayStart"];
            };
        };
        responses: {
            201: {
                content: {
                    "application/json": components["schemas"]["TuningStarted"];
                };
            };
        };
    };
    getTuningRun: {
        parameters: {
            query?: never;
            path: {
                run: number;
            };
        };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["TuningRunDetail"];
                };
            };
        };
    };
    deleteTuningRun: {
        parameters: {
            query?: never;
            path: {
                run: number;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    renameTuningRun: {
        parameters: {
            query?: never;
            path: {
                run: number;
            };
        };
        requestBody: {
            content: {
                "application/json": components["schemas"]["TuningName"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["TuningRunDetail"];
                };
            };
        };
    };
    getTuningState: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["TuningState"];
                };
            };
        };
    };
    stopTuningRun: {
        parameters: {
            query?: {
                /** @description the run that is meant: refused if it is over */
                run?: number | null;
            };
        };
        requestBody?: never;
        responses: {
            204: { content?: never };
        };
    };
    getUpdate: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["UpdateState"];
                };
            };
        };
    };
    beginUpdate: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["UpdateState"];
                };
            };
        };
    };
    sendRelease: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/zip": string;
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["UpdateState"];
                };
            };
        };
    };
    getVision: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["VisionSetup"];
                };
            };
        };
    };
    editVision: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["VisionEdit"];
            };
        };
        responses: {
            204: { content?: never };
        };
    };
    pickColour: {
        parameters: { query?: never };
        requestBody: {
            content: {
                /**
                 * @example {
                 *       "x": 0.5,
                 *       "y": 0.5
                 *     }
                 */
                "application/json": components["schemas"]["PickPlace"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["PickedColour"];
                };
            };
        };
    };
    readVision: {
        parameters: { query?: never };
        requestBody: {
            content: {
                "application/json": components["schemas"]["VisionText"];
            };
        };
        responses: {
            200: {
                content: {
                    "application/json": components["schemas"]["VisionSettings"];
                };
            };
        };
    };
    downloadVision: {
        parameters: { query?: never };
        requestBody?: never;
        responses: {
            200: {
                content: {
                    "text/plain": string;
                };
            };
        };
    };
}
