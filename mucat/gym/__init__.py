"""The robot in simulated water as environments of Gymnasium, which knows them once this is imported.

`pip install mucat[gym]` brings what they need.
"""

from gymnasium.envs.registration import register

ENVIRONMENT = "mucat.gym.environment:ScenarioEnvironment"

register("mucat/HoverInACurrent-v0", ENVIRONMENT, kwargs={"scenario": "hover_in_a_current"})
register("mucat/Scenario-v0", ENVIRONMENT)
