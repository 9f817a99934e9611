"""The gear file: records checked on load, frozen, with the unit in each key."""
