"""Events for other programs: alarms, sessions, tests and missions, by MQTT and webhooks."""
