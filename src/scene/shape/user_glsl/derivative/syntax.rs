//! The syntax tree of a text.

use super::types::Type;

/// An expression.
#[derive(Debug)]
pub struct Expression<'a> {
    pub kind: ExpressionKind<'a>,
    /// Levels of the tree below it, itself included.
    pub depth: usize,
}

#[derive(Debug)]
pub enum ExpressionKind<'a> {
    /// A literal number, or `true` or `false`.
    Literal(&'a str),
    Name(&'a str),
    /// A prefix operator.
    Prefix(&'a str, Box<Expression<'a>>),
    /// `x++` or `x--`.
    Postfix(&'a str, Box<Expression<'a>>),
    Binary(&'a str, Box<Expression<'a>>, Box<Expression<'a>>),
    /// An assignment with its operator.
    Assignment(&'a str, Box<Expression<'a>>, Box<Expression<'a>>),
    /// Condition, and the values where it is true and false.
    Choice([Box<Expression<'a>>; 3]),
    Index(Box<Expression<'a>>, Box<Expression<'a>>),
    /// Members of structures, and components.
    Member(Box<Expression<'a>>, &'a str),
    Call(&'a str, Vec<Expression<'a>>),
    Constructor(Type, Vec<Expression<'a>>),
    /// `array.length()`.
    Length(Box<Expression<'a>>),
}

/// A variable of a declaration.
#[derive(Debug)]
pub struct Variable<'a> {
    pub name: &'a str,
    pub of_type: Type,
    pub initial: Option<Expression<'a>>,
}

#[derive(Debug)]
pub struct Declaration<'a> {
    pub is_const: bool,
    pub variables: Vec<Variable<'a>>,
}

#[derive(Debug)]
pub enum Statement<'a> {
    Block(Vec<Statement<'a>>),
    Declaration(Declaration<'a>),
    Expression(Expression<'a>),
    If(Expression<'a>, Vec<Statement<'a>>, Vec<Statement<'a>>),
    For {
        first: Vec<Statement<'a>>,
        condition: Option<Expression<'a>>,
        step: Option<Expression<'a>>,
        body: Vec<Statement<'a>>,
    },
    While(Expression<'a>, Vec<Statement<'a>>),
    DoWhile(Vec<Statement<'a>>, Expression<'a>),
    Switch(Expression<'a>, Vec<Statement<'a>>),
    /// `case value:`, or `default:`.
    Case(Option<Expression<'a>>),
    Return(Option<Expression<'a>>),
    /// `break` or `continue`.
    Jump(&'a str),
}

#[derive(Debug)]
pub struct Parameter<'a> {
    pub name: &'a str,
    pub of_type: Type,
    /// Whether the function gets the argument's value.
    pub is_in: bool,
    /// Whether the argument gets the parameter's last value.
    pub is_out: bool,
}

#[derive(Debug)]
pub struct Function<'a> {
    pub name: &'a str,
    pub returns: Type,
    pub parameters: Vec<Parameter<'a>>,
    /// The statements, or the reason why they cannot be parsed: other functions may still be differentiated.
    pub body: Result<Vec<Statement<'a>>, super::Obstacle>,
}

#[derive(Debug)]
pub struct Structure<'a> {
    /// Empty for a structure without a name.
    pub name: &'a str,
    pub members: Vec<(&'a str, Type)>,
}

/// A whole text.
#[derive(Debug, Default)]
pub struct Program<'a> {
    pub structures: Vec<Structure<'a>>,
    pub globals: Vec<Declaration<'a>>,
    pub functions: Vec<Function<'a>>,
}
