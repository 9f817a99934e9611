"""The study of a net that is held in a flume tank."""
