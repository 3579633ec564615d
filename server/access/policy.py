"""What each operation of the interface needs; one that is not named here is refused to everybody."""

from enum import IntEnum


class Need(IntEnum):
    """What somebody must have; each includes those before it."""

    NOTHING = 0
    VIEWER = 1
    """To be signed in."""
    OPERATOR = 2
    """The role of an operator."""
    CONTROL = 3
    """To hold the control of the robot, which one page or program has at a time."""


OPERATIONS: dict[str, Need] = {
    "getMe": Need.NOTHING,
    "pairBrowser": Need.NOTHING,
    "signOut": Need.VIEWER,
    "makeCode": Need.OPERATOR,
    "listDevices": Need.OPERATOR,
    "changeDevice": Need.OPERATOR,
    "revokeDevice": Need.OPERATOR,
    "makeToken": Need.OPERATOR,
    "getHealth": Need.VIEWER,
    "getRobot": Need.VIEWER,
    "stopRobot": Need.VIEWER,
    "armRobot": Need.CONTROL,
    "putMode": Need.CONTROL,
    "checkFins": Need.CONTROL,
    "acknowledgeAlarms": Need.CONTROL,
    "putController": Need.CONTROL,
    "putLoop": Need.CONTROL,
    "putSetPoints": Need.CONTROL,
    "putSteering": Need.CONTROL,
    "putCard": Need.CONTROL,
    "putVision": Need.CONTROL,
    "putSimulator": Need.CONTROL,
    "putView": Need.OPERATOR,
    "getControl": Need.VIEWER,
    "openSeat": Need.OPERATOR,
    "takeControl": Need.OPERATOR,
    "releaseControl": Need.OPERATOR,
    "renewSeat": Need.OPERATOR,
    "refuseControl": Need.CONTROL,
    "handOverControl": Need.CONTROL,
    "getLinkFrames": Need.VIEWER,
    "listSessions": Need.VIEWER,
    "getSession": Need.VIEWER,
    "startSession": Need.OPERATOR,
    "stopSession": Need.OPERATOR,
    "changeSession": Need.OPERATOR,
    "deleteSession": Need.OPERATOR,
    "restoreSession": Need.OPERATOR,
    "purgeSession": Need.OPERATOR,
    "downloadSession": Need.VIEWER,
    "getThumbnail": Need.VIEWER,
    "addMark": Need.OPERATOR,
    "changeMark": Need.OPERATOR,
    "removeMark": Need.OPERATOR,
    "getBlocks": Need.VIEWER,
    "getTimeline": Need.VIEWER,
    "listSignals": Need.VIEWER,
    "getStorage": Need.VIEWER,
    "compareSessions": Need.VIEWER,
    "compareLines": Need.VIEWER,
    "getComparisonReport": Need.VIEWER,
    "listExports": Need.VIEWER,
    "getExport": Need.VIEWER,
    "downloadExport": Need.VIEWER,
    "startExport": Need.OPERATOR,
    "deleteExport": Need.OPERATOR,
    "importSession": Need.OPERATOR,
    "listTestDocuments": Need.VIEWER,
    "checkTestDocument": Need.VIEWER,
    "listTestRuns": Need.VIEWER,
    "getTestRun": Need.VIEWER,
    "downloadTestRunCsv": Need.VIEWER,
    "downloadTestRunJson": Need.VIEWER,
    "listTestTables": Need.VIEWER,
    "startTestRun": Need.OPERATOR,
    "cancelTestRun": Need.OPERATOR,
    "listScenarios": Need.VIEWER,
    "checkScenario": Need.VIEWER,
    "getScenarioState": Need.VIEWER,
    "keepScenario": Need.OPERATOR,
    "startScenario": Need.OPERATOR,
    "cancelScenario": Need.OPERATOR,
    "listLayouts": Need.VIEWER,
    "getLayout": Need.VIEWER,
    "saveLayout": Need.OPERATOR,
    "deleteLayout": Need.OPERATOR,
    "listPanels": Need.VIEWER,
    "getPanel": Need.VIEWER,
    "getPanelFrame": Need.VIEWER,
}
"""By `operation_id`. Where it depends on what is asked (a scenario on the robot), the route asks for more."""

MESSAGES: dict[str, Need] = {
    "ping": Need.VIEWER,
    "stop": Need.VIEWER,
    "watch": Need.VIEWER,
    "drive": Need.CONTROL,
}
"""By `op`, on the live socket."""
