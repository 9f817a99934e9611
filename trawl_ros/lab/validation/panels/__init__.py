"""Netting panels in a stream: published tests, and the model beside them."""
