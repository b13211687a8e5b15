"""The public library: what `import herijk` offers. Everything else may change without notice."""
