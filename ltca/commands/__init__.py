"""Commands of `ltca`: each module has SUMMARY, configure(parser) and execute(arguments), and imports lightly."""
